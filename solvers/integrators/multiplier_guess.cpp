#include "solvers/integrators/multiplier_guess.h"

#include <algorithm>

namespace taut {

MultiplierGuess::MultiplierGuess(const Rows& rows, const RowValues& values)
    : joints_(rows.joints().begin(), rows.joints().end()),
      contacts_(rows.contact_count()),
      forces_(values.force_multipliers),
      lambda_(values.lambda) {}

void MultiplierGuess::give(const Rows& rows, const ContactForces& contacts, RowValues& values) const {
  const auto give_rows = [&](const Rows::JointRows& joint, const Rows::JointRows& before) {
    if (joint.row_count != before.row_count) return;
    std::copy_n(forces_.begin() + before.first_row, before.row_count,
                values.force_multipliers.begin() + joint.first_row);
    std::copy_n(lambda_.begin() + before.first_row, before.row_count,
                values.lambda.begin() + joint.first_row);
  };
  const std::size_t joints_before = joints_.size() - contacts_;
  const std::size_t joints = std::min(rows.joints().size() - rows.contact_count(), joints_before);
  for (std::size_t j = 0; j < joints; ++j) give_rows(rows.joints()[j], joints_[j]);
  for (int k = 0; k < rows.contact_count(); ++k)
    if (const int before = contacts.inherited(k); before >= 0)
      give_rows(rows.joints()[rows.contact_joint(k)], joints_[joints_before + before]);
}

}  // namespace taut
