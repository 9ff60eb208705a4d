#include "core/impostor/frame_levels.hpp"

#include <glm/geometric.hpp>

#include <cmath>
#include <cstddef>

namespace thicket {

namespace {

std::size_t pixel_index(int x, int y, int side) {
	return static_cast<std::size_t>(y) * static_cast<std::size_t>(side) + static_cast<std::size_t>(x);
}

/// The mean of the covered pixels, weighted by coverage. If their normals cancel out, the result
/// has the normal of one of them.
class Mean {
public:
	void add(const glm::vec3 &color, const glm::vec3 &normal, float depth, float coverage) {
		sum_.color += color * coverage;
		sum_.normal += normal * coverage;
		sum_.depth += depth * coverage;
		sum_.coverage += coverage;
		any_normal_ = coverage > 0.0F ? normal : any_normal_;
	}

	/// Returns the mean. `full_coverage` is the total coverage if all pixels are fully covered.
	FramePixel result(float full_coverage) const {
		if (sum_.coverage <= 0.0F) {
			return {};
		}
		const float length = std::sqrt(glm::dot(sum_.normal, sum_.normal));
		return {sum_.color / sum_.coverage, length > 1e-3F * sum_.coverage ? sum_.normal / length : any_normal_,
				sum_.depth / sum_.coverage, sum_.coverage / full_coverage};
	}

private:
	FramePixel sum_;
	glm::vec3 any_normal_{0.0F};
};

} // namespace

FrameLevels::FrameLevels(int side) : side_(side) {
	for (int level_side = side; level_side > 0; level_side /= 2) {
		levels_.emplace_back(static_cast<std::size_t>(level_side) * static_cast<std::size_t>(level_side));
	}
}

void FrameLevels::compute(const FrameRaster &raster) {
	average(raster);
	for (int level = 1; level < count(); ++level) {
		shrink(level);
	}
	for (int level = count() - 1; level-- > 0;) {
		fill_holes(level);
	}
}

void FrameLevels::average(const FrameRaster &raster) {
	const int ratio = raster.side() / side_;
	const auto sample_count = static_cast<float>(ratio * ratio);
	for (int y = 0; y < side_; ++y) {
		for (int x = 0; x < side_; ++x) {
			Mean mean;
			for (int row = y * ratio; row < (y + 1) * ratio; ++row) {
				for (int column = x * ratio; column < (x + 1) * ratio; ++column) {
					const FrameSample &sample = raster.samples()[pixel_index(column, row, raster.side())];
					if (sample.is_covered()) {
						mean.add(sample.color, sample.normal, sample.depth, 1.0F);
					}
				}
			}
			levels_[0][pixel_index(x, y, side_)] = mean.result(sample_count);
		}
	}
}

void FrameLevels::shrink(int level) {
	const int level_side = side(level);
	const int finer_side = side(level - 1);
	const std::vector<FramePixel> &finer = levels_[static_cast<std::size_t>(level - 1)];
	for (int y = 0; y < level_side; ++y) {
		for (int x = 0; x < level_side; ++x) {
			Mean mean;
			for (const int row : {2 * y, 2 * y + 1}) {
				for (const int column : {2 * x, 2 * x + 1}) {
					const FramePixel &pixel = finer[pixel_index(column, row, finer_side)];
					mean.add(pixel.color, pixel.normal, pixel.depth, pixel.coverage);
				}
			}
			levels_[static_cast<std::size_t>(level)][pixel_index(x, y, level_side)] = mean.result(4.0F);
		}
	}
}

/// Fills holes from the next coarser level, whose holes must be filled already.
void FrameLevels::fill_holes(int level) {
	const int level_side = side(level);
	const std::vector<FramePixel> &coarser = levels_[static_cast<std::size_t>(level + 1)];
	for (int y = 0; y < level_side; ++y) {
		for (int x = 0; x < level_side; ++x) {
			FramePixel &pixel = levels_[static_cast<std::size_t>(level)][pixel_index(x, y, level_side)];
			if (pixel.coverage <= 0.0F) {
				pixel = coarser[pixel_index(x / 2, y / 2, level_side / 2)];
				pixel.coverage = 0.0F;
			}
		}
	}
}

} // namespace thicket
