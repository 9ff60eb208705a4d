#pragma once

#include "core/base/status.hpp"
#include "core/base/unique_number.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <limits>
#include <span>

namespace thicket {

class Surface;

/// The ground at a position: the height in world meters and the unit normal, y up. A height of NAN
/// means that there is no ground (outside the terrain, in a hole, or in water that a source
/// excludes).
struct Ground {
	float height = std::numeric_limits<float>::quiet_NaN();
	glm::vec3 normal{0.0f, 1.0f, 0.0f};
	float weight = 1.0f;  ///< Weight of the queried textures, 0 to 1; see Terrain::weigh().
	float density = 1.0f; ///< Product of the layer's density rules here, 0 to 1; 1 unless they are queried.
};

/// The ground properties that a caller needs in addition to the height. Sources compute only these
/// properties.
struct GroundNeeds {
	/// Textures to weigh; see Terrain::weigh(). If empty, the weight stays 1.
	std::span<const std::int32_t> textures;
	bool normals = true; ///< False if neither rules nor placement use normals.
};

/// The interface of ground sources, for many positions at a time. An implementation must be a pure
/// function of the position: repeated queries, in any batch, must return bit-identical results.
/// Otherwise, separately generated tiles would not match. Objects that several threads share do not
/// change, except for those without a version.
class Terrain {
public:
	virtual ~Terrain() = default;

	/// Returns a number that no other terrain has, or 0 if the results of this object may change
	/// during its lifetime, as those of a script may. Results that depend on the ground may be cached
	/// under this number. A copy has its own number.
	virtual std::uint64_t version() const { return number_.value(); }

	/// Writes the ground at `positions[i]` (world meters, the engine's x and z) to `r_ground[i]`.
	/// The spans must have equal length. A position that has no ground or is not finite gets a
	/// height of NAN and is not an error. Several threads may call this function concurrently, so
	/// an implementation must not store per-call state in the object.
	virtual Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const = 0;

	/// Writes the same heights as `sample`, for callers that need no normals. If normals are
	/// expensive, an implementation leaves those of `r_ground` unchanged. The heights are
	/// bit-identical to those of `sample`, except where `sample` rejects ground because of its
	/// normal.
	virtual Status sample_heights(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const {
		return sample(positions, r_ground);
	}

	/// Writes the total weight of `textures` at `positions[i]`, 0 to 1, to `r_ground[i].weight`.
	/// The source defines the texture numbers, for example texture layers or channels of a weight
	/// map. `positions` and `r_ground` must have equal length. The function is called after
	/// `sample`, with the same rules for threads and positions. A terrain without textures leaves
	/// all weights at 1, so it permits plants everywhere.
	virtual Status weigh([[maybe_unused]] std::span<const glm::dvec2> positions,
			[[maybe_unused]] std::span<const std::int32_t> textures,
			[[maybe_unused]] std::span<Ground> r_ground) const {
		return {};
	}

	/// Returns all surfaces of the ground, for layers that also grow on walls and undersides.
	/// Returns null for a terrain that only has heights. The pointer is valid for the terrain's
	/// lifetime, and any thread may use it.
	virtual const Surface *surface() const { return nullptr; }

	/// Queries the height and the properties that `needs` selects.
	Status query(std::span<const glm::dvec2> positions, const GroundNeeds &needs, std::span<Ground> r_ground) const {
		Status status;
		if (needs.normals) {
			status = sample(positions, r_ground);
		} else {
			status = sample_heights(positions, r_ground);
		}
		return status.ok() && !needs.textures.empty() ? weigh(positions, needs.textures, r_ground) : status;
	}

	/// Returns the ground at one position, or no ground if `sample` fails. For many positions,
	/// `sample` is faster.
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

private:
	UniqueNumber number_;
};

} // namespace thicket
