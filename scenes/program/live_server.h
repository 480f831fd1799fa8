#pragma once

#include <memory>
#include <string>
#include <vector>

namespace taut {

/// Serves one page and what moves on it (WebSocket) to browsers, in a thread of its own.  Whatever browsers
/// send or fail to send, the run goes on.
///
/// A request must name this server as its host, and a WebSocket come from a page of this server; else another
/// page in the same browser could drive the run.  Where others than this machine can reach it, both need the
/// token besides.
class LiveServer {
 public:
  /// What is to be served where.
  struct Options {
    std::string address = "127.0.0.1";  ///< of a network interface of this machine
    int port = 0;                       ///< 0: any that is free
  };
  /// @throws std::invalid_argument if the address is none, or cannot be listened at.
  LiveServer(const Options& options, std::string page);
  ~LiveServer();
  LiveServer(const LiveServer&) = delete;
  LiveServer& operator=(const LiveServer&) = delete;

  /// Where the page is, with its token if there is one.
  std::string url() const;

  /// A text that a browser has sent, or that it went away.
  struct Message {
    int browser = 0;    ///< its number
    bool gone = false;  ///< it went away: the last message of this number
    std::string text;
  };
  /// All messages since the last call, in their order.
  std::vector<Message> take();
  /// Waits until there is a message, a browser comes, or the time is over [s].
  void wait(double seconds);
  int browser_count() const;  ///< that are connected
  int browsers_seen() const;  ///< that ever were

  /// To all browsers, and first thing to those that come later.  One that is slow gets the newest only.
  void send_frame(std::string bytes);
  /// To one browser, as text.
  void send_text(int browser, std::string text);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Whether this build has the server: Boost.Beast was found.  Without it, what is above throws.
bool serves_live();

/// Whether an address can be reached from this machine alone.
/// @throws std::invalid_argument if it is no IPv4 or IPv6 address.
bool is_loopback(const std::string& address);

}  // namespace taut
