#pragma once

#include <cstddef>

namespace thicket {

/// Limits the uploads of one step to a few hundred microseconds, a small part of a frame.
class UploadStep {
public:
	/// Reports that a visual with this many instances was uploaded.
	void add(std::size_t instances) {
		++visuals_;
		instances_ += instances;
	}

	/// Returns true if no more visuals should be uploaded in this step. A new step is never full,
	/// so each step makes progress.
	bool is_full() const { return visuals_ >= max_visuals || instances_ >= max_instances; }

private:
	static constexpr std::size_t max_visuals = 4;
	static constexpr std::size_t max_instances = 4096;
	std::size_t visuals_ = 0;
	std::size_t instances_ = 0;
};

} // namespace thicket
