#include "scenes/program/live_run.h"

#include <charconv>
#include <iostream>
#include <nlohmann/json.hpp>

#include "core/base/check.h"
#include "scenes/export/page_data.h"
#include "scenes/program/interrupt.h"
#include "scenes/support/format.h"
#include "scenes/support/printable.h"

namespace taut {
namespace {

using Json = nlohmann::json;

constexpr double kShownPerSecond = 60;  // frames that browsers get
constexpr double kLookAround = 0.05;    // [s] between two looks for signals while nothing happens
constexpr double kLate = 0.1;           // [s] behind the clock; then the run no longer tries to catch up
constexpr int kMostNotes = 20;          // of ignored messages on the standard error

}  // namespace

LiveServer::Options live_server_options(const LiveOptions& options) {
  LiveServer::Options server;
  if (options.address && *options.address != "localhost") server.address = *options.address;
  (void)is_loopback(server.address);  // throws for what is none, and in builds without the server
  const std::string port = options.port.value_or("0");
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), server.port);
  if (error != std::errc() || end != port.data() + port.size() || server.port < 0 || server.port > 65535)
    fail("--live", "takes a port from 0 to 65535; other addresses than 127.0.0.1 are for --live-address",
         port);
  return server;
}

LiveRun::LiveRun(const LiveOptions& options, Scene& scene, Simulator& simulator, bool may_reset)
    : scene_(scene),
      simulator_(simulator),
      sampler_(scene),
      header_(sampler_.header(kShownPerSecond)),
      controls_(scene.world, simulator, may_reset) {
  PageData page = page_frame(header_, sampler_.sample(simulator), true);
  page.description["live"] = state();
  page.description["live"]["may_reset"] = may_reset;
  page.description["live"]["motors"] = controls_.motors();
  server_ = std::make_unique<LiveServer>(live_server_options(options), page_text(page, header_.scene));
  restart_clock();
}

Json LiveRun::state() const {
  Json all = controls_.state();
  all["status"] = status_;
  all["message"] = message_;
  return all;
}

bool LiveRun::is_waiting() const {
  if (server_->browsers_seen() == 0) return true;  // nothing is to be missed
  return controls_.is_waiting();
}

void LiveRun::restart_clock() { clock_ = Clock::now(), time_ = scene_.world.time(); }

bool LiveRun::before_step(double h) {
  while (true) {
    for (const LiveServer::Message& message : server_->take()) answer(message);
    if (InterruptGuard::signal() != 0) return false;
    const LiveControls::News news = controls_.take_news();
    if (news.pace) restart_clock();
    if (news.state) show();
    if (is_waiting()) {
      server_->wait(kLookAround);
      restart_clock();
      continue;
    }
    if (controls_.is_paused()) break;  // a single step
    const double ahead = (scene_.world.time() - time_) / controls_.speed() - seconds_since(clock_);
    if (ahead < -kLate) restart_clock();
    if (ahead <= 0) break;
    server_->wait(std::min(ahead, kLookAround));
  }
  controls_.begin_step(h);
  return true;
}

void LiveRun::after_step() {
  controls_.end_step();
  if (controls_.is_paused() || seconds_since(shown_) >= 1 / kShownPerSecond) show();
}

void LiveRun::show() {
  shown_ = Clock::now();
  PageData frame = page_frame(header_, sampler_.sample(simulator_), false);
  frame.description["live"] = state();
  server_->send_frame(frame.packed());
}

void LiveRun::finish(const std::string& status, const std::string& message) {
  status_ = status, message_ = message;
  try {
    show();
  } catch (const std::exception&) {
    // What ended the run may also keep its last state from being looked at.
  }
}

void LiveRun::answer(const LiveServer::Message& message) {
  if (message.gone) {
    controls_.forget(message.browser);
    return;
  }
  try {
    controls_.obey(message.browser, message.text);
  } catch (const std::exception& error) {
    note(message.browser, error.what());
  }
}

void LiveRun::note(int browser, const std::string& problem) {
  const std::string text = "a message is ignored: " + printable(problem);
  if (++notes_ <= kMostNotes)
    std::cerr << "taut: " << text << (notes_ == kMostNotes ? "; further ones are not shown" : "") << '\n';
  server_->send_text(browser, Json{{"notice", text}}.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace taut
