#pragma once

#include "core/base/status.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

inline constexpr std::size_t max_meshes = 256;

/// Refuses weights that are not finite, are negative or all 0, and more than max_meshes weights. An empty list is valid.
Status validate_mesh_weights(std::span<const float> weights);

/// Assigns each instance one of several meshes, by weight. A mesh of weight 0 is never assigned.
class MeshChoice {
public:
	/// `weights` must be valid; an empty list means one mesh.
	void set(std::span<const float> weights);

	/// The number of meshes, at least 1.
	std::size_t size() const { return ends_.size(); }

	/// The mesh for an instance. Depends only on its seed, its id and the weights.
	std::size_t mesh_for(std::uint64_t seed, std::uint64_t id) const;

private:
	/// For each mesh, the end of its share of the 2^32 values of a random word. The last mesh with a share ends at 2^32.
	std::vector<std::uint64_t> ends_{std::uint64_t{1} << 32};
};

} // namespace thicket
