#pragma once
// Cracks of rigid mortar that count (mortar_rows.hpp), of steps and of instants.

namespace masonry::wall::crack {

constexpr double counts = 0.01; // damage. Larger: it comes in jumps; smaller: unfinished iterations add up
constexpr double clear = 3;     // times the velocities that may be wrong, which an opening must be faster than

} // namespace masonry::wall::crack
