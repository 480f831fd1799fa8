#pragma once

#include <exception>
#include <string>
#include <vector>

#include "benchmarks/peers/peer.h"
#include "benchmarks/peers/plain_system.h"

namespace taut::peers {

PlainSystem plain(const System& system);

/// Poses and twists of all bodies but the ground.
void set_motion(const std::vector<PlainMotion>& bodies, State& state);

/// An engine behind a mechanism that reads plain motions and throws where it is at its end.
template <typename Mechanism>
class PlainEngine : public Engine {
 public:
  template <typename Settings>
  PlainEngine(const System& system, const Settings& settings) : mechanism_(plain(system), settings) {}

  void step() final {
    try {
      advance();
    } catch (const std::exception& error) {
      trouble_ = std::string("diverged: ").append(error.what()).substr(0, 160);
    }
  }
  std::string trouble() const final { return trouble_; }
  void read(State& state) final {
    mechanism_.read(bodies_);
    set_motion(bodies_, state);
  }

 protected:
  virtual void advance() = 0;

  Mechanism mechanism_;
  std::string trouble_;

 private:
  std::vector<PlainMotion> bodies_;
};

}  // namespace taut::peers
