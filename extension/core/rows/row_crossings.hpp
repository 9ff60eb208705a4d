#pragma once

#include <glm/vec2.hpp>

#include <optional>
#include <vector>

namespace thicket {

/// A straight part of a line.
struct RowSegment {
	glm::dvec2 from;
	glm::dvec2 to;
	bool starts_line = false; ///< True if `from` is an end of the line.
	bool ends_line = false;   ///< True if `to` is an end of the line.
};

/// Returns the position where two segments cross or touch. The ends of lines are extended by `extension`
/// meters, because a road often ends at the edge of another one. Parallel segments do not cross, and
/// neither do two lines where one of them continues the other. Segments must not have the length 0.
std::optional<glm::dvec2> crossing_of(const RowSegment &a, const RowSegment &b, double extension);

/// The positions at which lines cross.
class RowCrossings {
public:
	/// Replaces the positions.
	void set(std::vector<glm::dvec2> positions);

	/// Returns true if a crossing is nearer than `distance` meters to a position.
	bool is_near(glm::dvec2 position, double distance) const;

private:
	std::vector<glm::dvec2> positions_; ///< Sorted by x.
};

} // namespace thicket
