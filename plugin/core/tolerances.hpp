#pragma once
// Every tolerance of the physics, each relative to a size or a speed of the scene: a scene scaled in length and
// time gives the scaled answer. One line of consequence each.

namespace masonry::tolerance {

} // namespace masonry::tolerance
