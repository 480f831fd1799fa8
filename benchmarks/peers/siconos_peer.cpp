#include "benchmarks/peers/plain.h"
#include "benchmarks/peers/siconos_mechanism.h"

/// Siconos: maximal coordinates, the Moreau–Jean scheme.  Methods: moreau (joints closed in velocities),
/// projection (and then in positions, by dense LU); blocks (1: sparse blocks and MUMPS, 0: dense LU), theta,
/// newton (iterations), ntol and, of the projection, tol and iters.
namespace {

using namespace taut;
using namespace taut::peers;

SiconosSettings settings_of(const System& system, const Method& method, double dt) {
  if (method.name != "moreau" && method.name != "projection") throw Unsupported("method " + method.name);
  SiconosSettings out;
  out.projection = method.name == "projection";
  if (out.projection && system.joints.size() > SiconosMechanism::kMaxProjectedJoints)
    throw Unsupported("a projection of more than 199 joints");
  out.blocks = method.get("blocks", 1) != 0;
  out.theta = method.get("theta", 0.5);
  out.newton_iterations = static_cast<int>(method.get("newton", 50));
  out.newton_tolerance = method.get("ntol", 1e-6);
  out.constraint_tolerance = method.get("tol", 5e-7);
  out.projection_iterations = static_cast<int>(method.get("iters", 50));
  out.dt = dt;
  return out;
}

class SiconosEngine final : public PlainEngine<SiconosMechanism> {
 public:
  SiconosEngine(const System& system, const Method& method, double dt)
      : PlainEngine(system, settings_of(system, method, dt)) {}

 private:
  void advance() override {
    mechanism_.step();
    if (const int error = mechanism_.solver_error(); error != 0)
      trouble_ = std::string("diverged: solver error ").append(std::to_string(error));
  }
};

}  // namespace

int main(int argc, char** argv) {
  return peer_main(argc, argv, "Siconos", [](const System& system, const Method& method, double dt) {
    return std::make_unique<SiconosEngine>(system, method, dt);
  });
}
