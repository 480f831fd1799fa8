#include <sys/utsname.h>

#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>

#include "scenes/bench/bench_report.h"
#include "solvers/simulator/simulator.h"

namespace taut {
namespace {

/// What follows the colon in the first line of a file that starts so, or "".
std::string value_in(const char* file, const std::string& key) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);)
    if (line.rfind(key, 0) == 0 && line.find(": ") != line.npos) return line.substr(line.find(": ") + 2);
  return "";
}

}  // namespace

nlohmann::ordered_json machine_description() {
  utsname system{};
  uname(&system);
  double load = 0;
  getloadavg(&load, 1);
  World world;
  std::ifstream meminfo("/proc/meminfo");
  std::string key;
  double kilobytes = 0;
  meminfo >> key >> kilobytes;
  return {{"processor", value_in("/proc/cpuinfo", "model name")},
          {"cores", std::thread::hardware_concurrency()},
          {"memory_gb", kilobytes / 1024 / 1024},
          {"system", std::string(system.sysname) + " " + system.release + " " + system.machine},
          {"compiler", std::string("GCC or Clang ") + __VERSION__},
          {"solver", Simulator(world).solver_description()},
          {"load_at_start", load}};
}

}  // namespace taut
