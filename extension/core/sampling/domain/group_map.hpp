#pragma once

#include "core/sampling/domain/zeroed_array.hpp"

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>

namespace thicket {

/// Records which groups of 3 x 3 base squares are active for the wavefront, one bit per group
/// (section 4.3 of the paper, see DomainMethod).
class GroupMap {
public:
	static constexpr std::uint32_t width = 3;

	GroupMap(glm::uvec2 squares, bool toroidal) :
			squares_(squares), groups_((squares + width - 1u) / width), toroidal_(toroidal),
			active_((std::size_t{groups_.x} * groups_.y + 63) / 64) {}

	std::size_t bytes() const { return active_.bytes(); }

	/// Activates a group, unless it is active already. Calls push(square) for each of its base
	/// squares.
	template <class Push>
	void activate(glm::uvec2 group, Push &&push) {
		const std::size_t index = std::size_t{group.y} * groups_.x + group.x;
		std::uint64_t &word = active_[index / 64];
		const std::uint64_t bit = std::uint64_t{1} << index % 64;
		if ((word & bit) != 0) {
			return;
		}
		word |= bit;
		const glm::uvec2 first = group * width;
		const glm::uvec2 end = glm::min(first + width, squares_);
		for (std::uint32_t y = first.y; y < end.y; ++y) {
			for (std::uint32_t x = first.x; x < end.x; ++x) {
				push(glm::uvec2(x, y));
			}
		}
	}

	/// Activates the group of a base square and the groups of the domain around it. A group is
	/// wider than two radii, so this activates the whole open area around an accepted dart's disk.
	template <class Push>
	void activate_around(glm::uvec2 square, Push &&push) {
		const glm::ivec2 middle(square / width);
		const glm::ivec2 count(groups_);
		for (int y = middle.y - 1; y <= middle.y + 1; ++y) {
			for (int x = middle.x - 1; x <= middle.x + 1; ++x) {
				const bool inside = x >= 0 && y >= 0 && x < count.x && y < count.y;
				if (inside || toroidal_) {
					activate(glm::uvec2((glm::ivec2(x, y) + count) % count), push);
				}
			}
		}
	}

private:
	glm::uvec2 squares_;
	glm::uvec2 groups_;
	bool toroidal_;
	ZeroedArray<std::uint64_t> active_;
};

} // namespace thicket
