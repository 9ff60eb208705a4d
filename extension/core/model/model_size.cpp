#include "core/model/model_size.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace thicket {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

constexpr double min_footprint = 0.6; // Fraction of the total width.

} // namespace

const ModelMeasure::Extent ModelMeasure::nothing{infinity, -infinity, infinity, -infinity};

void ModelMeasure::Extent::add(double x, double z) {
	low_x = std::min(low_x, x);
	high_x = std::max(high_x, x);
	low_z = std::min(low_z, z);
	high_z = std::max(high_z, z);
}

void ModelMeasure::Extent::add(const Extent &other) {
	if (!other.is_empty()) {
		add(other.low_x, other.low_z);
		add(other.high_x, other.high_z);
	}
}

ModelMeasure::ModelMeasure(const glm::dvec3 &low, const glm::dvec3 &high) : low_(low), high_(high) {
	extents_.fill(nothing);
}

void ModelMeasure::add(const std::array<glm::dvec3, 3> &triangle) {
	volume_ += glm::dot(triangle[0] - low_, glm::cross(triangle[1] - low_, triangle[2] - low_)) / 6.0;
	const double tall = std::max(high_.y - low_.y, 1e-9);
	const auto slice_of = [&](double y) {
		const double fraction = (y - low_.y) / tall * static_cast<double>(slices);
		return static_cast<std::size_t>(std::clamp(fraction, 0.0, static_cast<double>(slices - 1)));
	};
	for (std::size_t corner = 0; corner < 3; ++corner) {
		glm::dvec3 from = triangle[corner];
		glm::dvec3 to = triangle[(corner + 1) % 3];
		if (to.y < from.y) {
			std::swap(from, to);
		}
		// The loop adds both ends of the edge's part in each slice. They bound the triangle's part
		// of the slice.
		const std::size_t last = slice_of(to.y);
		for (std::size_t slice = slice_of(from.y); slice <= last; ++slice) {
			const double bottom = low_.y + tall * static_cast<double>(slice) / static_cast<double>(slices);
			const double top = low_.y + tall * static_cast<double>(slice + 1) / static_cast<double>(slices);
			for (const double y : {std::max(from.y, bottom), std::min(to.y, top)}) {
				const double fraction = to.y > from.y ? std::clamp((y - from.y) / (to.y - from.y), 0.0, 1.0) : 0.0;
				extents_[slice].add(from.x + (to.x - from.x) * fraction, from.z + (to.z - from.z) * fraction);
			}
		}
	}
}

ModelMeasure::Extent ModelMeasure::extent_between(double bottom, double top) const {
	const double tall = high_.y - low_.y;
	Extent result = nothing;
	for (std::size_t slice = 0; slice < slices; ++slice) {
		const double from = low_.y + tall * static_cast<double>(slice) / static_cast<double>(slices);
		const double to = low_.y + tall * static_cast<double>(slice + 1) / static_cast<double>(slices);
		if (to > bottom && from < top) {
			result.add(extents_[slice]);
		}
	}
	return result;
}

ModelSize ModelMeasure::size() const {
	ModelSize result;
	const glm::dvec3 box = glm::max(high_ - low_, glm::dvec3(0.0));
	result.width = 0.5 * (box.x + box.z);
	result.height = std::max(high_.y, 0.0);
	result.depth = std::max(-low_.y, 0.0);
	std::array<double, slices> widths{};
	std::ranges::transform(extents_, widths.begin(), [](const Extent &extent) { return extent.width(); });
	const auto end = std::remove(widths.begin(), widths.end(), 0.0);
	const auto wide = widths.begin() + (end - widths.begin()) * 3 / 4;
	std::nth_element(widths.begin(), wide, end);
	const double typical = end == widths.begin() ? result.width : *wide;
	result.footprint = std::clamp(typical, min_footprint * result.width, result.width);
	const double ground = std::max(low_.y, 0.0);
	result.base = extent_between(ground, ground + 0.1 * (high_.y - ground)).width();
	const double space = box.x * box.y * box.z;
	result.fill = space > 0.0 ? std::min(std::abs(volume_) / space, 1.0) : 0.0;
	return result;
}

} // namespace thicket
