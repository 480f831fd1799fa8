#include "scenes/gnuplot.h"

#include <iostream>

#include "core/check.h"
#include "scenes/child_process.h"
#include "scenes/output_file.h"
#include "scenes/temporary_folder.h"

namespace taut {

void draw(const std::string& script, const std::string& command) {
  const TemporaryFolder folder("plots");
  const std::string file = (folder.path() / "plots.gp").string();
  if (const std::string error = write_output(file, script); !error.empty())
    fail("plots", "cannot write the file", error);
  const ChildResult plots = run_child("/usr/bin/env", {"gnuplot", file}, false, 60);
  if (!plots.good()) std::cerr << command << ": no pictures: gnuplot " << plots.message() << '\n';
}

}  // namespace taut
