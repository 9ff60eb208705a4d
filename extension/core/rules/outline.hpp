#pragma once

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// A line through many points, ready for questions about places: a tree of boxes over runs of consecutive edges, two runs a
/// box. O(n) memory and time to build; a question looks at about log n boxes where points follow each other as they do on a
/// drawn line, and at all edges where they jump at random. Metres.
class Outline {
public:
	/// Through `points`, at least one, finite; `closed` adds the edge from the last to the first.
	void set(std::span<const glm::dvec2> points, bool closed);

	/// True strictly within a closed outline by the even-odd rule; edges and corners are not within.
	bool contains(glm::dvec2 place) const;

	/// Metres from `place` to the nearest edge, or `limit` if that is less.
	double distance(glm::dvec2 place, double limit) const;

private:
	struct Box {
		glm::dvec2 min;
		glm::dvec2 max;
	};

	/// A run of (run_edges << level) edges, the last one of a level shorter.
	struct Run {
		std::uint32_t level;
		std::uint32_t index;
	};

	static constexpr std::size_t run_edges = 4;

	std::size_t edges() const { return points_.size() - 1; }
	std::size_t begin_of(Run run) const { return static_cast<std::size_t>(run.index) * (run_edges << run.level); }
	std::size_t end_of(Run run) const;
	const Box &box_of(Run run) const { return boxes_[level_begin_[run.level] + run.index]; }
	bool has(Run run) const { return level_begin_[run.level] + run.index < level_begin_[run.level + 1]; }
	Run root() const { return {static_cast<std::uint32_t>(level_begin_.size() - 2), 0}; }

	std::vector<glm::dvec2> points_;         ///< Of a closed one, the first once more at the end.
	std::vector<Box> boxes_;                 ///< Level by level, the shortest runs first.
	std::vector<std::uint32_t> level_begin_; ///< Into boxes_; one more than levels.
};

} // namespace thicket
