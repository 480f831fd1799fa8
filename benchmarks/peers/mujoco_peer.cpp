#include <mujoco/mujoco.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "benchmarks/peers/mujoco_model.h"

/// MuJoCo.  Methods: newton, cg (iters, tol), stiff=1 (constraints as hard as the step allows), free=1 (all
/// bodies free), rk4=1; of contact elliptic=1 (cones), noslip (iterations).
namespace {

using namespace taut;
using namespace taut::peers;

std::string g_error;

mjModel* load(const std::string& xml) {
  const std::string file =
      (std::filesystem::temp_directory_path() / ("peer" + std::to_string(getpid()) + ".xml")).string();
  std::ofstream(file) << xml;
  char error[1000] = "";
  mjModel* model = mj_loadXML(file.c_str(), nullptr, error, sizeof error);
  std::filesystem::remove(file);
  if (!model) throw Unsupported(error);
  return model;
}

class MujocoEngine final : public Engine {
 public:
  MujocoEngine(const System& system, const Method& method, double dt) {
    mju_user_error = [](const char* message) {
      std::fprintf(stderr, "%s\n", message);
      std::_Exit(3);
    };
    mju_user_warning = [](const char* message) { g_error = message; };
    const MujocoModel description = mujoco_model(system, method, dt);
    model_ = load(description.xml);
    data_ = mj_makeData(model_);
    for (const std::string& name : description.body_names)
      id_.push_back(mj_name2id(model_, mjOBJ_BODY, name.c_str()));
    id_[0] = 0;
  }
  ~MujocoEngine() override {
    mj_deleteData(data_);
    mj_deleteModel(model_);
  }
  MujocoEngine(const MujocoEngine&) = delete;
  MujocoEngine& operator=(const MujocoEngine&) = delete;

  void step() override { mj_step(model_, data_); }
  std::string trouble() const override {
    if (g_error.empty()) return "";
    return (g_error.find("full") != std::string::npos ? "no room: " : "diverged: ") + g_error;
  }
  void read(State& state) override {
    mj_kinematics(model_, data_);
    mj_comPos(model_, data_);
    mj_comVel(model_, data_);
    for (std::size_t b = 1; b < id_.size(); ++b) {
      const mjtNum *p = data_->xipos + 3 * id_[b], *q = data_->xquat + 4 * id_[b];
      mjtNum v[6];
      mj_objectVelocity(model_, data_, mjOBJ_BODY, id_[b], v, 0);
      state.poses[b] = {Quat(q[0], q[1], q[2], q[3]).normalized(), Vec3(p[0], p[1], p[2])};
      state.twists[b] = {Vec3(v[0], v[1], v[2]), Vec3(v[3], v[4], v[5])};
    }
  }

 private:
  mjModel* model_ = nullptr;
  mjData* data_ = nullptr;
  std::vector<int> id_;
};

}  // namespace

int main(int argc, char** argv) {
  return peer_main(argc, argv, "MuJoCo", [](const System& system, const Method& method, double dt) {
    return std::make_unique<MujocoEngine>(system, method, dt);
  });
}
