#pragma once

#include "core/base/status.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <limits>
#include <span>

namespace thicket {

/// The ground at a position: its height in world meters, and its unit normal, y up. A height of NAN means that there is no ground (off
/// the terrain, a hole, water that a source excludes).
struct Ground {
	float height = std::numeric_limits<float>::quiet_NaN();
	glm::vec3 normal{0.0f, 1.0f, 0.0f};
	float weight = 1.0f; ///< Share of the ground with the queried textures, 0 to 1; see Terrain::weigh.
};

/// The ground properties that callers need in addition to the height. A source is queried for nothing else.
struct GroundNeeds {
	std::span<const std::int32_t> textures; ///< Textures to weigh, see Terrain::weigh. If empty, the weight stays 1.
	bool normals = true;                    ///< False if no rule and no placement reads normals.
};

/// Ground for many positions at a time. An implementation must be a pure function of the position: repeated queries, in any batch, return
/// the same bits. Otherwise, separately generated tiles would not fit together.
class Terrain {
public:
	virtual ~Terrain() = default;

	/// Writes the ground at `positions[i]` (world meters, x and z of the engine) to `r_ground[i]`. The spans have equal length. A
	/// position without ground, including NAN and infinite ones, gets a height of NAN and is not an error. Called from several threads
	/// concurrently, so an implementation must not store state of a call.
	virtual Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const = 0;

	/// Like `sample`, for callers that need no normals. A terrain whose normals are expensive leaves those of `r_ground` unchanged. The
	/// heights are bit-identical, except where `sample` refuses ground because of its normal.
	virtual Status sample_heights(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const {
		return sample(positions, r_ground);
	}

	/// Writes to `r_ground[i].weight` the share of the ground at `positions[i]` with any of `textures`, 0 to 1. `textures` are numbers
	/// defined by the source: texture layers, channels of a weight map. `positions` and `r_ground` have equal length. Called after
	/// `sample`, under the same rules. A terrain without textures leaves the weight at 1, which permits all ground.
	virtual Status weigh([[maybe_unused]] std::span<const glm::dvec2> positions,
			[[maybe_unused]] std::span<const std::int32_t> textures,
			[[maybe_unused]] std::span<Ground> r_ground) const {
		return {};
	}

	/// Queries the parts of the ground listed in `needs`, and no others.
	Status query(std::span<const glm::dvec2> positions, const GroundNeeds &needs, std::span<Ground> r_ground) const {
		Status status;
		if (needs.normals) {
			status = sample(positions, r_ground);
		} else {
			// Queries only heights, because no caller reads the normals.
			status = sample_heights(positions, r_ground);
		}
		return status.ok() && !needs.textures.empty() ? weigh(positions, needs.textures, r_ground) : status;
	}

	/// The ground at one position, or no ground if `sample` fails. For many positions, `sample` is cheaper.
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
