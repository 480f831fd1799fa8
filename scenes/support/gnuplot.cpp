#include "scenes/support/gnuplot.h"

#include <iostream>

#include "core/base/check.h"
#include "scenes/support/child_process.h"
#include "scenes/support/output_file.h"
#include "scenes/support/temporary_folder.h"

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
