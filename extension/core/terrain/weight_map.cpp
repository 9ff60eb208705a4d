#include "core/terrain/weight_map.hpp"

#include "core/base/check.hpp"
#include "core/base/floating_point.hpp"
#include "core/base/guard.hpp"
#include "core/terrain/changed_blocks.hpp"

#include <glm/common.hpp>

#include <algorithm>

namespace thicket {

namespace {

/// Two neighboring pixels on an axis, and the fraction of the way from the first to the second.
struct Between {
	int first;
	int second;
	double part;
};

/// Returns the pixels around `position`, which must be in 0 to 1.
Between between(double position, int pixels) {
	const double along = position * (pixels - 1);
	const int first = static_cast<int>(along);
	return {first, std::min(first + 1, pixels - 1), along - first};
}

} // namespace

Status WeightMap::set(glm::ivec2 size, int channels, std::span<const std::uint8_t> weights) {
	const Status status = first_failure(check_range("weight_size", size.x, 1, max_side),
			check_range("weight_size", size.y, 1, max_side), check_range("weight_channels", channels, 1, max_channels));
	if (!status.ok()) {
		return status;
	}
	const std::size_t bytes =
			static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) * static_cast<std::size_t>(channels);
	if (weights.size() != bytes) {
		return Status::wrong_size("weights", weights.size(), exactly(bytes, "bytes"));
	}
	return guarded("weights", static_cast<double>(bytes), [&] {
		weights_ = std::make_shared<const std::vector<std::uint8_t>>(weights.begin(), weights.end());
		size_ = size;
		channels_ = channels;
	});
}

void WeightMap::add_changes(const WeightMap &other, std::vector<Rect> &r_rects) const {
	if (weights_ == other.weights_) {
		// Both maps share this memory, so their weights are equal.
		return;
	}
	if (empty() || other.empty() || size_ != other.size_ || channels_ != other.channels_) {
		r_rects.push_back({glm::dvec2(0.0), glm::dvec2(1.0)});
		return;
	}
	const auto bytes_of = [this](const WeightMap &map) {
		return [this, &map](int column, int row) {
			return map.weights_->data() + (static_cast<std::ptrdiff_t>(row) * size_.x + column) * channels_;
		};
	};
	std::vector<PixelRect> changed;
	add_changed_blocks(size_, static_cast<std::size_t>(channels_), bytes_of(*this), bytes_of(other), changed);
	const glm::dvec2 steps = glm::max(glm::dvec2(size_ - 1), glm::dvec2(1.0));
	for (const PixelRect &rect : changed) {
		// Interpolation extends the effect of a pixel to its neighbors.
		r_rects.push_back({glm::max(glm::dvec2(rect.min - 1) / steps, glm::dvec2(0.0)),
				glm::min(glm::dvec2(rect.max) / steps, glm::dvec2(1.0))});
	}
}

unsigned WeightMap::channels_of(std::span<const std::int32_t> textures) const {
	unsigned channels = 0;
	for (const std::int32_t texture : textures) {
		if (texture >= 0 && texture < channels_) {
			channels |= 1u << static_cast<unsigned>(texture);
		}
	}
	return channels;
}

float WeightMap::weight(glm::dvec2 position, unsigned channels) const {
	const auto unit = [](double value) {
		return value > 0.0 ? std::min(value, 1.0) : 0.0; // The condition is false for NAN, which becomes 0.
	};
	const Between x = between(unit(position.x), size_.x);
	const Between y = between(unit(position.y), size_.y);
	const auto row = [&](int index) {
		const double first = sum(x.first, index, channels);
		return first + (sum(x.second, index, channels) - first) * x.part;
	};
	const double near = row(y.first);
	const double all = near + (row(y.second) - near) * y.part;
	return static_cast<float>(std::clamp(all / 255.0, 0.0, 1.0));
}

int WeightMap::sum(int column, int row, unsigned channels) const {
	const std::size_t pixel =
			static_cast<std::size_t>(row) * static_cast<std::size_t>(size_.x) + static_cast<std::size_t>(column);
	const std::size_t first = pixel * static_cast<std::size_t>(channels_);
	int result = 0;
	for (unsigned channel = 0; channel < static_cast<unsigned>(channels_); ++channel) {
		if ((channels >> channel & 1u) != 0) {
			result += (*weights_)[first + channel];
		}
	}
	return result;
}

} // namespace thicket
