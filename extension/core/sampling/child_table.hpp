#pragma once

#include "core/base/split_mix.hpp"
#include "core/sampling/dart.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace thicket {

/// Maps each subset of a square's four children (one bit each) to the constants of these children,
/// packed without gaps. The constants distinguish a child from its siblings.
struct ChildTable {
	struct Line {
		alignas(32) std::uint64_t gamma[4]{};  ///< Added to the parent's key before hashing.
		alignas(16) std::uint32_t corner[4]{}; ///< All bits set on each axis on which the child is the upper one.
		std::uint32_t count = 0;
	};
	std::array<Line, 16> lines{};

	constexpr const Line &operator[](std::uint64_t children) const { return lines[static_cast<std::size_t>(children)]; }
};

constexpr ChildTable make_child_table() {
	ChildTable table;
	for (std::uint32_t children = 0; children < 16; ++children) {
		ChildTable::Line &line = table.lines[children];
		for (std::uint32_t child = 0; child < 4; ++child) {
			if ((children >> child & 1) != 0) {
				line.gamma[line.count] = (child + 1) * split_mix_gamma;
				line.corner[line.count] =
						((child & 1) != 0 ? cell_mask : 0) | ((child & 2) != 0 ? cell_mask << lattice_bits : 0);
				++line.count;
			}
		}
	}
	return table;
}

inline constexpr ChildTable child_table = make_child_table();

} // namespace thicket
