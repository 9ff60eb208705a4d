#include "core/placement/mesh_choice.hpp"

#include "core/base/check.hpp"
#include "core/rules/instance_random.hpp"

#include <limits>
#include <numeric>

namespace thicket {

Status validate_mesh_weights(std::span<const float> weights) {
	if (weights.size() > max_meshes) {
		return Status::out_of_range("mesh_weights", weights.size(), at_most(max_meshes, "entries"));
	}
	for (const float weight : weights) {
		const Status status = check_range("mesh_weights", weight, 0.0, std::numeric_limits<float>::max());
		if (!status.ok()) {
			return status;
		}
	}
	const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
	return weights.empty() ? Status{} : check_positive("mesh_weights", sum);
}

void MeshChoice::set(std::span<const float> weights) {
	ends_.assign(weights.empty() ? 1 : weights.size(), std::uint64_t{1} << 32);
	const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
	double before = 0.0;
	for (std::size_t mesh = 0; mesh < weights.size(); ++mesh) {
		before += weights[mesh];
		// The weights are added in the same order as in `sum`, so that the result is exactly 2^32
		// from the last weight above 0 on.
		ends_[mesh] = end_of(before, sum);
	}
}

std::uint32_t MeshChoice::word_of(std::uint64_t seed, std::uint64_t id) {
	return instance_random(seed, id, Draw::mesh)[0];
}

std::size_t MeshChoice::mesh_for(std::uint64_t seed, std::uint64_t id) const {
	if (ends_.size() == 1) {
		// There is only one mesh, so no random number is needed.
		return 0;
	}
	const std::uint32_t word = word_of(seed, id);
	// The ends are ascending, so the number of ends at or below the word is the index. Counting
	// avoids a branch, which would often be mispredicted.
	std::size_t mesh = 0;
	for (const std::uint64_t end : ends_) {
		mesh += word >= end ? 1 : 0;
	}
	return mesh;
}

} // namespace thicket
