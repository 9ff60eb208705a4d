#include "core/terrain/combined_terrain.hpp"

#include "core/base/floating_point.hpp"
#include "core/base/guard.hpp"

#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <tuple>
#include <utility>

namespace thicket {

namespace {

/// Positions are handled in groups of this size, whose ground fits on the stack.
constexpr std::size_t positions_per_group = 256;

using GroundGroup = std::array<Ground, positions_per_group>;

/// Calls `handle(first, count)` for each group of positions, until one fails.
template <class Handle>
Status each_group(std::size_t positions, const Handle &handle) {
	for (std::size_t first = 0; first < positions; first += positions_per_group) {
		const Status status = handle(first, std::min(positions_per_group, positions - first));
		if (!status.ok()) {
			return status;
		}
	}
	return {};
}

/// Orders numbers by value, and negative zero before zero.
std::int32_t order_of(float number) {
	const auto bits = std::bit_cast<std::int32_t>(number);
	return bits < 0 ? bits ^ std::numeric_limits<std::int32_t>::max() : bits;
}

bool takes_priority(const glm::vec3 &normal, const glm::vec3 &other) {
	const auto key = [](const glm::vec3 &of) {
		return std::tuple(order_of(of.y), order_of(of.x), order_of(of.z));
	};
	return key(normal) > key(other);
}

} // namespace

std::uint64_t CombinedTerrain::version() const {
	const bool may_change = std::ranges::any_of(parts_, [](const Part &part) { return part->version() == 0; });
	return may_change ? 0 : Terrain::version();
}

Status CombinedTerrain::set(std::span<const Part> parts) {
	return guarded("parts", static_cast<double>(parts.size()), [&]() -> Status {
		CombinedTerrain combined;
		std::vector<Surface::Part> surfaces;
		std::size_t triangles = 0;
		for (const Part &part : parts) {
			if (std::ranges::find(combined.parts_, part) != combined.parts_.end()) {
				continue;
			}
			combined.parts_.push_back(part);
			if (const Surface *surface = part->surface()) {
				surfaces.emplace_back(part, surface);
				triangles += surface->triangle_count();
			}
		}
		if (triangles > Surface::max_triangles) {
			return Status::out_of_range("triangles of all parts", triangles, at_most(Surface::max_triangles));
		}
		if (!surfaces.empty()) {
			combined.surface_ = Surface::of_parts(surfaces);
		}
		*this = std::move(combined);
		return {};
	});
}

void CombinedTerrain::raise(const Ground &ground, Ground &r_top) {
	if (std::isnan(ground.height) || ground.height < r_top.height) {
		return;
	}
	if (ground.height != r_top.height) {
		r_top = ground;
		return;
	}
	r_top.height = order_of(ground.height) > order_of(r_top.height) ? ground.height : r_top.height;
	r_top.normal = takes_priority(ground.normal, r_top.normal) ? ground.normal : r_top.normal;
	r_top.weight = std::max(ground.weight, r_top.weight);
}

Status CombinedTerrain::sample_by(
		SampleMethod method, std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const {
	if (positions.size() != r_ground.size()) {
		return Status::wrong_size("ground", r_ground.size(), exactly(positions.size()));
	}
	return each_group(positions.size(), [&](std::size_t first, std::size_t count) -> Status {
		const std::span<Ground> tops = r_ground.subspan(first, count);
		std::ranges::fill(tops, Ground{});
		for (const Part &part : parts_) {
			GroundGroup group;
			const std::span<Ground> ground(group.data(), count);
			const Status status = (part.get()->*method)(positions.subspan(first, count), ground);
			if (!status.ok()) {
				return status;
			}
			for (std::size_t i = 0; i < count; ++i) {
				raise(ground[i], tops[i]);
			}
		}
		return {};
	});
}

Status CombinedTerrain::sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const {
	return sample_by(&Terrain::sample, positions, r_ground);
}

Status CombinedTerrain::sample_heights(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const {
	return sample_by(&Terrain::sample_heights, positions, r_ground);
}

Status CombinedTerrain::weigh(std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures,
		std::span<Ground> r_ground) const {
	if (positions.size() != r_ground.size()) {
		return Status::wrong_size("ground", r_ground.size(), exactly(positions.size()));
	}
	return each_group(positions.size(), [&](std::size_t first, std::size_t count) {
		return weigh_some(positions.subspan(first, count), textures, r_ground.subspan(first, count));
	});
}

/// Weighs a group of positions. A part is the ground where its height is that of the ground.
Status CombinedTerrain::weigh_some(std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures,
		std::span<Ground> r_ground) const {
	constexpr float unknown = -1.0F;
	std::array<float, positions_per_group> weights{};
	weights.fill(unknown);
	for (const Part &part : parts_) {
		GroundGroup group;
		if (const Status status = part->sample_heights(positions, std::span(group.data(), positions.size()));
				!status.ok()) {
			return status;
		}
		std::array<std::size_t, positions_per_group> indices{};
		std::array<glm::dvec2, positions_per_group> part_positions{};
		std::size_t count = 0;
		for (std::size_t i = 0; i < positions.size(); ++i) {
			if (group[i].height == r_ground[i].height) {
				group[count] = {r_ground[i].height, r_ground[i].normal};
				part_positions[count] = positions[i];
				indices[count++] = i;
			}
		}
		if (count == 0) {
			continue;
		}
		const Status status =
				part->weigh(std::span(part_positions.data(), count), textures, std::span(group.data(), count));
		if (!status.ok()) {
			return status;
		}
		for (std::size_t i = 0; i < count; ++i) {
			weights[indices[i]] = std::max(weights[indices[i]], group[i].weight);
		}
	}
	for (std::size_t i = 0; i < positions.size(); ++i) {
		r_ground[i].weight = weights[i] == unknown ? r_ground[i].weight : weights[i];
	}
	return {};
}

} // namespace thicket
