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

constexpr double least_footprint = 0.6; // Of the whole width.
constexpr double tan_25_degrees = 0.46630765815499858;

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
		const double share = (y - low_.y) / tall * static_cast<double>(slices);
		return static_cast<std::size_t>(std::clamp(share, 0.0, static_cast<double>(slices - 1)));
	};
	for (std::size_t corner = 0; corner < 3; ++corner) {
		glm::dvec3 from = triangle[corner];
		glm::dvec3 to = triangle[(corner + 1) % 3];
		if (to.y < from.y) {
			std::swap(from, to);
		}
		// The ends of the edge's part in each slice. The triangle's part lies between those of its edges.
		const std::size_t last = slice_of(to.y);
		for (std::size_t slice = slice_of(from.y); slice <= last; ++slice) {
			const double bottom = low_.y + tall * static_cast<double>(slice) / static_cast<double>(slices);
			const double top = low_.y + tall * static_cast<double>(slice + 1) / static_cast<double>(slices);
			for (const double y : {std::max(from.y, bottom), std::min(to.y, top)}) {
				const double share = to.y > from.y ? std::clamp((y - from.y) / (to.y - from.y), 0.0, 1.0) : 0.0;
				extents_[slice].add(from.x + (to.x - from.x) * share, from.z + (to.z - from.z) * share);
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
	result.footprint = std::clamp(typical, least_footprint * result.width, result.width);
	const double ground = std::max(low_.y, 0.0);
	result.base = extent_between(ground, ground + 0.1 * (high_.y - ground)).width();
	const double space = box.x * box.y * box.z;
	result.fill = space > 0.0 ? std::min(std::abs(volume_) / space, 1.0) : 0.0;
	return result;
}

ModelKind kind_of(const ModelSize &size) {
	const double tall = size.height + size.depth;
	if (tall >= 2.5 && tall >= 1.2 * size.width) {
		return ModelKind::tree;
	}
	if (size.fill >= 0.25) {
		return ModelKind::rock;
	}
	return tall < 0.7 ? ModelKind::grass : ModelKind::shrub;
}

ModelFit fit_of(ModelKind kind, const ModelSize &size) {
	ModelFit fit;
	const double below_slope = 0.5 * size.base * tan_25_degrees; // The lowest edge of an upright base.
	double sink = 0.0;
	switch (kind) {
		case ModelKind::tree:
			fit = {.radius = 0.9 * size.footprint,
					.density = 0.85,
					.min_scale = 0.75,
					.max_scale = 1.25,
					.max_tilt_degrees = 4.0};
			sink = below_slope;
			break;
		case ModelKind::shrub:
			fit = {.radius = size.footprint,
					.density = 0.8,
					.min_scale = 0.65,
					.max_scale = 1.3,
					.max_tilt_degrees = 8.0,
					.align_to_normal = 0.3};
			fit.clump_size = 10.0 * fit.radius;
			sink = std::min(below_slope, 0.15 * size.height) * (1.0 - fit.align_to_normal);
			break;
		case ModelKind::grass:
			fit = {.radius = 0.7 * size.footprint,
					.min_scale = 0.7,
					.max_scale = 1.3,
					.max_tilt_degrees = 10.0,
					.align_to_normal = 0.7};
			sink = std::min(below_slope, 0.2 * size.height) * (1.0 - fit.align_to_normal);
			break;
		case ModelKind::rock:
			fit = {.radius = 1.6 * size.footprint,
					.density = 0.7,
					.min_scale = 0.4,
					.max_scale = 1.4,
					.max_tilt_degrees = 12.0,
					.align_to_normal = 0.6};
			fit.clump_size = 12.0 * fit.radius;
			fit.clump_coverage = 0.3;
			sink = 0.2 * size.height;
			break;
	}
	fit.height_offset = std::min(size.depth - sink, 0.0);
	return fit;
}

} // namespace thicket
