#include "benchmarks/peers/plain.h"
#include "benchmarks/peers/simbody_mechanism.h"

/// Simbody: reduced coordinates of the spanning tree, loops closed by constraints and projection.  Methods:
/// rkm (Runge–Kutta–Merson with error control: acc, default 1e-3), euler (semi-explicit, fixed step); ctol.
namespace {

using namespace taut;
using namespace taut::peers;

SimbodySettings settings_of(const Method& method, double dt) {
  if (method.name != "rkm" && method.name != "euler") throw Unsupported("method " + method.name);
  return {method.name == "euler", method.get("acc", 1e-3), method.get("ctol", 0), dt};
}

class SimbodyEngine final : public PlainEngine<SimbodyMechanism> {
 public:
  SimbodyEngine(const System& system, const Method& method, double dt)
      : PlainEngine(system, settings_of(method, dt)), dt_(dt) {}

 private:
  void advance() override { mechanism_.step_to(++steps_ * dt_); }

  double dt_;
  int steps_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  return peer_main(argc, argv, "Simbody", [](const System& system, const Method& method, double dt) {
    return std::make_unique<SimbodyEngine>(system, method, dt);
  });
}
