#pragma once

#include <cstddef>

namespace thicket {

/// Limits what one step uploads, so that it takes a small part of a frame's time: some hundred microseconds.
class UploadStep {
public:
	/// A visual with this many instances was uploaded.
	void add(std::size_t instances) {
		++visuals_;
		instances_ += instances;
	}

	/// True if nothing more should be uploaded in this step. A new step is never full, so each step uploads something.
	bool is_full() const { return visuals_ >= most_visuals || instances_ >= most_instances; }

private:
	static constexpr std::size_t most_visuals = 4;
	static constexpr std::size_t most_instances = 4096;
	std::size_t visuals_ = 0;
	std::size_t instances_ = 0;
};

} // namespace thicket
