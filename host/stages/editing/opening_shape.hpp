#pragma once
#include <optional>

#include "stages/editing/opening_evidence.hpp"

namespace hybrid::stages {

// The border as builders draw one, where the samples contradict that no more than they contradict `ring`: a
// circle, or two upright jambs on a level sill under a lintel or an arch, segmental, round or pointed (two
// arcs about the springing line). Its few numbers are fitted to all samples around it at once: lines of sight
// that passed belong inside, samples on the face outside, each with a quarter of a cell to spare; what is on
// the wrong side costs its distance, up to a few cells. So the border stays true where a part of it is hidden
// or glass swallowed the rays, and lies finer than the samples' spacing. Nothing where no such shape fits.
std::optional<Ring2> regular_border(const Ring2& ring, const std::vector<EvidenceMark>& marks, double cell_m);

// Another opening's border laid around a piece of an opening: moved to where the samples contradict it least.
struct LikeBorder {
  Ring2 ring;
  double contradictions = 0;  // samples on its wrong side
};
enum class Moves { anywhere, sideways };
// Nothing where they contradict it more than they contradict `ring`, or where they do not hold it: it fits as
// well three cells aside. `sideways`: at the level where it is, as one of a row of windows.
std::optional<LikeBorder> border_like(const Ring2& design, const Ring2& ring,
                                      const std::vector<EvidenceMark>& marks, double cell_m,
                                      Moves moves = Moves::anywhere);

}  // namespace hybrid::stages
