#include "scenes/program/live_server.h"

#include "core/base/check.h"

#ifdef TAUT_LIVE
#include <boost/asio/ip/host_name.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <random>
#include <set>
#include <thread>

#include "scenes/support/format.h"
#endif

namespace taut {

#ifdef TAUT_LIVE
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace net = boost::asio;
namespace websocket = beast::websocket;
using tcp = net::ip::tcp;
using Bytes = std::shared_ptr<const std::string>;

constexpr int kMostBrowsers = 16;
constexpr std::size_t kLongestMessage = 1 << 16;  // [bytes] that a browser may send at once
constexpr std::size_t kMostUnread = 1000;         // messages that wait for the run; more are dropped
constexpr std::size_t kMostWaiting = 64;  // messages that wait for a browser; further ones are dropped
constexpr auto kFarewell = std::chrono::milliseconds(150);  // for the last frame to get out
constexpr auto kRecovery = std::chrono::milliseconds(100);  // after a connection could not be taken
constexpr auto kPatience = std::chrono::seconds(30);        // with a request that does not come to its end

/// 128 random bits.
std::string random_token() {
  std::random_device source;
  std::string token;
  for (int i = 0; i < 4; ++i) token += format("%08x", source());
  return token;
}

/// Takes as long for any wrong text, so that nothing is learnt from the time.
bool same_text(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) difference |= static_cast<unsigned char>(a[i] ^ b[i]);
  return difference == 0;
}

/// The value of a key in `/path?key=value&…`; empty if there is none.
std::string_view query_value(std::string_view target, std::string_view key) {
  std::size_t at = target.find('?');
  while (at != std::string_view::npos) {
    std::string_view rest = target.substr(at + 1);
    const std::size_t end = rest.find('&');
    const std::string_view pair = rest.substr(0, end);
    if (pair.substr(0, key.size()) == key && pair.substr(key.size(), 1) == "=")
      return pair.substr(key.size() + 1);
    at = end == std::string_view::npos ? end : at + 1 + end;
  }
  return {};
}

net::ip::address parsed_address(const std::string& text) {
  boost::system::error_code error;
  const auto address = net::ip::make_address(text, error);
  if (error) fail("--live-address", "is no IPv4 or IPv6 address", text);
  return address;
}

/// What the thread of the run and that of the server share.
struct Inbox {
  std::mutex mutex;
  std::condition_variable news;
  std::vector<LiveServer::Message> messages;
  int connected = 0, seen = 0;

  void add(LiveServer::Message message) {
    const std::lock_guard lock(mutex);
    if (messages.size() < kMostUnread || message.gone) messages.push_back(std::move(message));
    news.notify_all();
  }
  void count(int change) {
    const std::lock_guard lock(mutex);
    connected += change;
    seen += change > 0 ? 1 : 0;
    news.notify_all();
  }
};

class Browser;

/// What connections need to know; only the thread of the server touches it.
struct Hub {
  std::string page, token;
  std::set<std::string> hosts;  // under which requests may come; empty: any, which need the token then
  std::map<int, std::shared_ptr<Browser>> browsers;
  Bytes last_frame;
  int next = 1;
  Inbox inbox;

  bool knows_host(std::string_view host) const { return hosts.empty() || hosts.contains(std::string(host)); }
  bool has_token(std::string_view target) const {
    return token.empty() || same_text(query_value(target, "token"), token);
  }
};

/// A page that shows the run.
class Browser : public std::enable_shared_from_this<Browser> {
 public:
  Browser(Hub& hub, tcp::socket socket, int number)
      : hub_(hub), number_(number), socket_(std::move(socket)) {}

  void accept(const http::request<http::string_body>& request) {
    socket_.set_option(websocket::stream_base::timeout::suggested(beast::role_type::server));
    socket_.read_message_max(kLongestMessage);
    socket_.async_accept(request, [self = shared_from_this()](beast::error_code error) {
      if (error) return;
      self->hub_.browsers[self->number_] = self;
      self->is_open_ = true;
      self->hub_.inbox.count(1);
      if (self->hub_.last_frame) self->send(self->hub_.last_frame, true);
      self->read();
    });
  }
  void send(Bytes bytes, bool is_frame) {
    // Of frames that have not been sent yet only the newest counts; the first in the queue is on its way.
    if (is_frame && queue_.size() > 1 && queue_.back().second) queue_.pop_back();
    if (queue_.size() >= kMostWaiting) return;
    queue_.emplace_back(std::move(bytes), is_frame);
    if (queue_.size() == 1) write();
  }
  void leave() {
    if (!is_open_) return;
    is_open_ = false;
    hub_.browsers.erase(number_);
    hub_.inbox.count(-1);
    hub_.inbox.add({number_, true, ""});
    beast::get_lowest_layer(socket_).close();
  }

 private:
  void read() {
    socket_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (error) return self->leave();
      // What is no text is given on as such: the run says what it ignores.
      std::string text =
          self->socket_.got_text() ? beast::buffers_to_string(self->buffer_.data()) : "(bytes)";
      self->hub_.inbox.add({self->number_, false, std::move(text)});
      self->buffer_.consume(self->buffer_.size());
      self->read();
    });
  }
  void write() {
    socket_.binary(queue_.front().second);
    socket_.async_write(net::buffer(*queue_.front().first),
                        [self = shared_from_this()](beast::error_code error, std::size_t) {
                          if (error) return self->leave();
                          self->queue_.pop_front();
                          if (!self->queue_.empty()) self->write();
                        });
  }

  Hub& hub_;
  int number_;
  websocket::stream<beast::tcp_stream> socket_;
  beast::flat_buffer buffer_;
  std::deque<std::pair<Bytes, bool>> queue_;  // and whether it is a frame
  bool is_open_ = false;
};

/// One request: for the page, or to become a WebSocket.
class Request : public std::enable_shared_from_this<Request> {
 public:
  Request(Hub& hub, tcp::socket socket) : hub_(hub), stream_(std::move(socket)) {
    parser_.header_limit(1 << 14);
    parser_.body_limit(1 << 10);
  }
  void read() {
    stream_.expires_after(kPatience);
    http::async_read(stream_, buffer_, parser_,
                     [self = shared_from_this()](beast::error_code error, std::size_t) {
                       if (!error) self->answer();
                     });
  }

 private:
  void answer() {
    const auto& request = parser_.get();
    const std::string target(request.target()), path = target.substr(0, target.find('?'));
    const std::string host(request[http::field::host]);
    if (!hub_.knows_host(host)) return say(http::status::forbidden, "This server has another name.\n");
    if (!hub_.has_token(target))
      return say(http::status::forbidden, "The address lacks the token that taut has printed.\n");
    if (path == "/live" && websocket::is_upgrade(request)) {
      if (request[http::field::origin] != "http://" + host)
        return say(http::status::forbidden, "Other pages may not drive the run.\n");
      if (hub_.browsers.size() >= kMostBrowsers)
        return say(http::status::service_unavailable, "Too many pages show this run.\n");
      stream_.expires_never();
      return std::make_shared<Browser>(hub_, stream_.release_socket(), hub_.next++)->accept(request);
    }
    if (request.method() != http::verb::get) return say(http::status::method_not_allowed, "Only GET.\n");
    if (path != "/") return say(http::status::not_found, "There is one page, at /.\n");
    say(http::status::ok, hub_.page, "text/html; charset=utf-8");
  }
  void say(http::status status, const std::string& text, const char* type = "text/plain; charset=utf-8") {
    response_.version(parser_.get().version());
    response_.result(status);
    response_.set(http::field::content_type, type);
    response_.set(http::field::cache_control, "no-store");
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set(http::field::x_frame_options, "DENY");
    response_.set("Referrer-Policy", "no-referrer");
    response_.keep_alive(false);
    response_.body() = text;
    response_.prepare_payload();
    stream_.expires_after(kPatience);
    http::async_write(stream_, response_, [self = shared_from_this()](beast::error_code, std::size_t) {
      beast::error_code ignored;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    });
  }

  Hub& hub_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_;
  http::request_parser<http::string_body> parser_;
  http::response<http::string_body> response_;
};

}  // namespace

class LiveServer::Impl {
 public:
  Impl(const Options& options, std::string page) : acceptor_(context_) {
    const net::ip::address address = parsed_address(options.address);
    try {
      const tcp::endpoint here(address, static_cast<unsigned short>(options.port));
      acceptor_.open(here.protocol());
      acceptor_.set_option(net::socket_base::reuse_address(true));
      acceptor_.bind(here);
      acceptor_.listen();
    } catch (const boost::system::system_error& error) {
      fail("--live", "cannot listen there (" + error.code().message() + ")",
           options.address + ":" + std::to_string(options.port));
    }
    const std::string port = ":" + std::to_string(acceptor_.local_endpoint().port());
    const std::string name = address.is_v6() ? "[" + address.to_string() + "]" : address.to_string();
    hub_.page = std::move(page);
    if (address.is_loopback())
      hub_.hosts = {name + port, "localhost" + port};
    else
      hub_.token = random_token();
    // 0.0.0.0 and :: are no places to go to.
    const std::string place = address.is_unspecified() ? net::ip::host_name() : name;
    url_ = "http://" + place + port + "/" + (hub_.token.empty() ? "" : "?token=" + hub_.token);
    accept();
    thread_ = std::thread([this] { run(); });
  }
  ~Impl() {
    if (connected(hub_.inbox) > 0) std::this_thread::sleep_for(kFarewell);
    context_.stop();
    thread_.join();
    hub_.browsers.clear();  // before the context of their sockets
  }

  template <typename Work>
  void post(Work work) {
    net::post(context_, std::move(work));
  }
  Hub& hub() { return hub_; }
  static int connected(Inbox& inbox) {
    const std::lock_guard lock(inbox.mutex);
    return inbox.connected;
  }
  const std::string& url() const { return url_; }

 private:
  void accept() {
    acceptor_.async_accept([this](beast::error_code error, tcp::socket socket) {
      if (error == net::error::operation_aborted) return;
      if (!error) {
        std::make_shared<Request>(hub_, std::move(socket))->read();
        return accept();
      }
      // There may be no descriptors left: asking again at once would take the whole processor.
      pause_.expires_after(kRecovery);
      pause_.async_wait([this](beast::error_code stopped) {
        if (!stopped) accept();
      });
    });
  }
  /// One connection that goes wrong is no reason to leave the others.
  void run() {
    while (true) try {
        context_.run();
        return;
      } catch (const std::exception&) {
      }
  }

  Hub hub_;  // outlives the connections in the context
  net::io_context context_{1};
  tcp::acceptor acceptor_;
  net::steady_timer pause_{context_};
  std::string url_;
  std::thread thread_;
};

LiveServer::LiveServer(const Options& options, std::string page)
    : impl_(std::make_unique<Impl>(options, std::move(page))) {}

LiveServer::~LiveServer() = default;

std::string LiveServer::url() const { return impl_->url(); }

std::vector<LiveServer::Message> LiveServer::take() {
  Inbox& inbox = impl_->hub().inbox;
  const std::lock_guard lock(inbox.mutex);
  return std::exchange(inbox.messages, {});
}

void LiveServer::wait(double seconds) {
  Inbox& inbox = impl_->hub().inbox;
  std::unique_lock lock(inbox.mutex);
  const int seen = inbox.seen;
  inbox.news.wait_for(lock, std::chrono::duration<double>(seconds),
                      [&] { return !inbox.messages.empty() || inbox.seen != seen; });
}

int LiveServer::browser_count() const { return Impl::connected(impl_->hub().inbox); }

int LiveServer::browsers_seen() const {
  Inbox& inbox = impl_->hub().inbox;
  const std::lock_guard lock(inbox.mutex);
  return inbox.seen;
}

void LiveServer::send_frame(std::string bytes) {
  impl_->post([&hub = impl_->hub(), frame = std::make_shared<const std::string>(std::move(bytes))] {
    hub.last_frame = frame;
    const auto all = hub.browsers;  // one that leaves is no longer in the hub's
    for (const auto& [number, browser] : all) browser->send(frame, true);
  });
}

void LiveServer::send_text(int browser, std::string text) {
  impl_->post([&hub = impl_->hub(), browser, bytes = std::make_shared<const std::string>(std::move(text))] {
    if (const auto found = hub.browsers.find(browser); found != hub.browsers.end())
      std::shared_ptr(found->second)->send(bytes, false);
  });
}

bool is_loopback(const std::string& address) { return parsed_address(address).is_loopback(); }

bool serves_live() { return true; }

#else

namespace {

[[noreturn]] void refuse(const std::string& address) {
  fail("--live", "this build has no server; on Debian: apt-get install libboost-dev, then build again",
       address);
}

}  // namespace

class LiveServer::Impl {};
LiveServer::LiveServer(const Options& options, std::string) { refuse(options.address); }
LiveServer::~LiveServer() = default;
std::string LiveServer::url() const { return ""; }
std::vector<LiveServer::Message> LiveServer::take() { return {}; }
void LiveServer::wait(double) {}
int LiveServer::browser_count() const { return 0; }
int LiveServer::browsers_seen() const { return 0; }
void LiveServer::send_frame(std::string) {}
void LiveServer::send_text(int, std::string) {}
bool is_loopback(const std::string& address) { refuse(address); }
bool serves_live() { return false; }

#endif

}  // namespace taut
