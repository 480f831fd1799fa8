#pragma once

#include <cstdint>
#include <vector>

#include "scenes/export/page_columns.h"
#include "scenes/recording/recording.h"

namespace taut {

/// The contacts of a page: bodies, places on a grid of 65,535 steps over the box around all of them, and
/// forces with 9 significant bits.  Normals are not shown, so they are left out.
///
/// A contact is predicted by the one of the frame before that is as many-th of the same two bodies, or by
/// zero: what rests costs nothing.
class ContactColumns {
 public:
  static constexpr std::size_t kBytes = 20;  ///< per contact, before compression

  void add(const Frame& frame);
  void write(ColumnWriter& columns) const;

 private:
  Words place_words(const Vec3& low, const Vec3& step) const;
  /// Differences to the predictions, modulo 2¹⁶; three words per contact.
  Words rest(const Words& words) const;

  std::vector<std::uint32_t> counts_;
  Words bodies_;  // low and high word of A and of B
  std::vector<Vec3> places_;
  HalfColumn forces_;
  std::vector<std::int64_t> predecessors_;  // index of a contact of the frame before, −1: none
  std::size_t previous_ = 0;                // first contact of the frame before
};

}  // namespace taut
