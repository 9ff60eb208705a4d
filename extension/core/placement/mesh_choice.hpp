#pragma once

#include "core/base/status.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

inline constexpr std::size_t max_meshes = 256;

/// Returns an error for weights that are negative, not finite or all 0, and for more than
/// max_meshes weights. An empty list is valid.
Status validate_mesh_weights(std::span<const float> weights);

/// Assigns a random mesh to each instance, with probabilities proportional to weights. A mesh of
/// weight 0 is never assigned.
class MeshChoice {
public:
	/// `weights` must be valid; an empty list means one mesh.
	void set(std::span<const float> weights);

	/// Returns the number of meshes, at least 1.
	std::size_t size() const { return ends_.size(); }

	/// Returns the index of the mesh for an instance. It depends only on the seed, the id and the
	/// weights.
	std::size_t mesh_for(std::uint64_t seed, std::uint64_t id) const;

	/// Returns the random word that chooses the mesh of an instance: the first mesh whose end
	/// exceeds the word.
	static std::uint32_t word_of(std::uint64_t seed, std::uint64_t id);

	/// Returns the exclusive end of a mesh's range of words. `before` is the sum of the weights up to
	/// and including the mesh, and `sum` is that of all weights, added in the same order.
	static std::uint64_t end_of(double before, double sum) { return static_cast<std::uint64_t>(before / sum * 0x1p32); }

private:
	/// For each mesh, the exclusive end of its range of random 32-bit words. The last mesh with a
	/// weight above 0 ends at 2^32.
	std::vector<std::uint64_t> ends_{std::uint64_t{1} << 32};
};

} // namespace thicket
