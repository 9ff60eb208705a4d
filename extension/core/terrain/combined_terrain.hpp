#pragma once

#include "core/terrain/surface.hpp"
#include "core/terrain/terrain.hpp"

#include <glm/vec2.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// Several terrains above each other: at each position, the highest ground is used. Results do not
/// depend on the order of the terrains, bit for bit. Immutable after `set`.
class CombinedTerrain final : public Terrain {
public:
	using Part = std::shared_ptr<const Terrain>;

	/// Repeated parts are ignored. No part may be null. Returns an error if the surfaces of all
	/// parts together have more than Surface::max_triangles triangles. A failed call leaves the
	/// terrain unchanged.
	Status set(std::span<const Part> parts);

	/// Returns 0 if the version of any part is 0.
	std::uint64_t version() const override;

	/// See Terrain::sample(). If several parts have exactly the same height, see raise().
	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override;
	Status sample_heights(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override;

	/// See Terrain::weigh(). Only the part that is the ground is used, so ground of a part without
	/// textures has a weight of 1, even above a part with textures.
	Status weigh(std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures,
			std::span<Ground> r_ground) const override;

	/// Returns the surfaces of all parts that have one; null if there are none.
	const Surface *surface() const override { return surface_.get(); }

	/// Replaces `r_top` with `ground` if that is higher. At the same height, chooses the normal
	/// with the largest y, then x, then z, and the larger weight. The result does not depend on the
	/// order of calls, not even in the sign of zero.
	static void raise(const Ground &ground, Ground &r_top);

private:
	using SampleMethod = Status (Terrain::*)(std::span<const glm::dvec2>, std::span<Ground>) const;
	Status sample_by(SampleMethod method, std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const;
	Status weigh_some(std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures,
			std::span<Ground> r_ground) const;

	std::vector<Part> parts_;
	std::shared_ptr<const Surface> surface_;
};

} // namespace thicket
