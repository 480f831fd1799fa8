#include "scenes/gnuplot.h"

#include <fstream>
#include <iostream>

#include "core/check.h"
#include "scenes/child_process.h"

namespace taut {

void draw(const std::string& script, const std::filesystem::path& folder, const std::string& command) {
  const std::filesystem::path file = folder / "plots.gp";
  std::ofstream out(file);
  if (!(out << script << std::flush)) fail("plots", "cannot write the file", file.string());
  const ChildResult plots = run_child("/usr/bin/env", {"gnuplot", file.string()}, false, 60);
  if (!plots.good()) std::cerr << command << ": no pictures: gnuplot " << plots.message() << '\n';
  std::filesystem::remove(file);
}

}  // namespace taut
