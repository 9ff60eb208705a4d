#pragma once

#include "core/base/status.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

inline constexpr std::size_t max_meshes = 256;

/// Refuses weights that are not finite, negative, or all 0, and more than max_meshes of them. None at all are fine.
Status validate_mesh_weights(std::span<const float> weights);

/// Gives every instance one of several meshes, by weight. A mesh of weight 0 is given to none.
class MeshChoice {
public:
	/// `weights` must be valid; none means one mesh.
	void set(std::span<const float> weights);

	/// How many meshes there are, 1 at least.
	std::size_t size() const { return ends_.size(); }

	/// The mesh for an instance: a function of its seed, its id and the weights.
	std::size_t mesh_for(std::uint64_t seed, std::uint64_t id) const;

private:
	/// For each mesh the end of its share of the 2^32 values that a random word has; the last that has a share ends
	/// there.
	std::vector<std::uint64_t> ends_{std::uint64_t{1} << 32};
};

} // namespace thicket
