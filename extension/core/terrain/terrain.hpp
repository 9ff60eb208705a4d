#pragma once

#include "core/base/status.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <limits>
#include <span>

namespace thicket {

/// What lies under a position: the height of the ground in world meters, and its unit normal, y up. A height of NAN
/// means that there is no ground (off the terrain, a hole, water that a source leaves out).
struct Ground {
	float height = std::numeric_limits<float>::quiet_NaN();
	glm::vec3 normal{0.0f, 1.0f, 0.0f};
	float weight = 1.0f; ///< How much of it belongs to the textures that were asked for, 0 to 1; see Terrain::weigh.
};

/// What callers have to know of the ground beside its height. A source is called for nothing else.
struct GroundNeeds {
	std::span<const std::int32_t>
			textures;    ///< Those whose weight counts, see Terrain::weigh; none: the weight stays 1.
	bool normals = true; ///< False where no rule and no placement reads normals.
};

/// Ground for many positions at once. An implementation is a pure function of the position: asked twice, in whatever
/// batch, it gives the same bits, or tiles that were made apart would not fit.
class Terrain {
public:
	virtual ~Terrain() = default;

	/// Writes the ground at `positions[i]` (world meters, x and z of the engine) to `r_ground[i]`. The spans are of
	/// equal length; a position without ground, NAN and infinite ones included, gets a height of NAN and is no error.
	/// Called from several threads at once, so an implementation keeps no state of the call.
	virtual Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const = 0;

	/// As `sample`, for callers that need no normals: a terrain to which normals are expensive leaves those of `r_ground` as they are. The
	/// heights are bit-identical, except where `sample` refuses ground because of its normal.
	virtual Status sample_heights(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const {
		return sample(positions, r_ground);
	}

	/// Writes to `r_ground[i].weight` how much of the ground at `positions[i]` belongs to any of `textures` (numbers of the
	/// source's own: texture layers, channels of a weight map), 0 to 1. The spans of positions are of equal length. Called after
	/// `sample`, under the same rules. A terrain without textures leaves 1: it allows all.
	virtual Status weigh([[maybe_unused]] std::span<const glm::dvec2> positions,
			[[maybe_unused]] std::span<const std::int32_t> textures,
			[[maybe_unused]] std::span<Ground> r_ground) const {
		return {};
	}

	/// The parts of the ground that `needs` names, and no others.
	Status query(std::span<const glm::dvec2> positions, const GroundNeeds &needs, std::span<Ground> r_ground) const {
		Status status;
		if (needs.normals) {
			status = sample(positions, r_ground);
		} else {
			// Fast path: heights alone, since no caller reads the normals.
			status = sample_heights(positions, r_ground);
		}
		return status.ok() && !needs.textures.empty() ? weigh(positions, needs.textures, r_ground) : status;
	}

	/// The ground at one position; no ground if `sample` fails. For many positions, `sample` is the cheaper.
	Ground at(glm::dvec2 position) const {
		Ground ground;
		return sample({&position, 1}, {&ground, 1}).ok() ? ground : Ground{};
	}

protected:
	Terrain() = default;
	Terrain(const Terrain &) = default;
	Terrain &operator=(const Terrain &) = default;
	Terrain(Terrain &&) = default;
	Terrain &operator=(Terrain &&) = default;
};

} // namespace thicket
