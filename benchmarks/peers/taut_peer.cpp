#include "benchmarks/peers/peer.h"
#include "solvers/simulator/simulator.h"

/// taut itself, through the same door.  Methods: rattle, rattle4, implicit (geometric stiffness), fixed
/// (rattle whose step no tension cuts, as that of most others).  No other engine keeps a ledger of energy in
/// its steps, so that taut's is off too; what is said of energy is measured from outside for all.
namespace {

using namespace taut;
using namespace taut::peers;

Settings settings_of(const Method& method) {
  Settings settings;
  if (method.name == "rattle4")
    settings.integrator = Integrator::kRattle4;
  else if (method.name == "implicit")
    settings.tension = TensionPolicy::kImplicit;
  else if (method.name == "fixed")
    settings.tension = TensionPolicy::kIgnore;
  else if (method.name != "rattle")
    throw Unsupported("method " + method.name);
  settings.threads = 1;
  settings.report_energy = method.get("ledger", 0) != 0;
  settings.position_tolerance = method.get("tol", settings.position_tolerance);
  return settings;
}

class TautEngine final : public Engine {
 public:
  TautEngine(const System& system, const Method& method, double dt)
      : world_(*system.world), simulator_(world_, settings_of(method)), dt_(dt) {}
  void step() override { ok_ = simulator_.step(dt_).exact(); }
  void read(State& state) override { state = world_.state(); }
  std::string trouble() const override { return ok_ ? "" : simulator_.report().message; }

 private:
  World world_;
  Simulator simulator_;
  double dt_;
  bool ok_ = true;
};

}  // namespace

int main(int argc, char** argv) {
  return peer_main(argc, argv, "taut", [](const System& system, const Method& method, double dt) {
    return std::make_unique<TautEngine>(system, method, dt);
  });
}
