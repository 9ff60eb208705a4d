#include "core/rules/sphere_image.hpp"

#include "core/base/floating_point.hpp"

#include <algorithm>

namespace thicket {

namespace {

/// Returns a fraction of the whole circle, 0 to 0.5, whose cosine is at least `cosine`.
double turns_within(double cosine) {
	if (cosine <= -1.0) {
		return 0.5;
	}
	return angle_degrees(std::sqrt(std::max(0.0, 1.0 - cosine * cosine)), cosine) / 360.0;
}

} // namespace

void find_sphere_disc(glm::ivec2 size, const glm::dvec3 &middle, double distance, std::vector<PixelRect> &r_rows) {
	const glm::dvec2 at = sphere_image_position(middle);
	const double level = std::sqrt(middle.x * middle.x + middle.z * middle.z);
	const double cosine = 1.0 - 0.5 * distance * distance;
	const int middle_row = std::min(static_cast<int>(at.y * size.y), size.y - 1);
	const int middle_column = static_cast<int>(at.x * size.x) % size.x;
	for (int row = 0; row < size.y; ++row) {
		const Rotation from_pole = rotation_by((row + 0.5) / size.y * 0.5);
		// A direction at `turns` from the middle's meridian is in the disc if from_pole.sine * level *
		// cos(turns) is at least this number.
		const double needed = cosine - from_pole.cosine * middle.y;
		const double most = from_pole.sine * level;
		int first = middle_column;
		int end = middle_column + (row == middle_row ? 1 : 0);
		if (needed <= most) {
			const double turns = turns_within(most > 0.0 ? needed / most : -1.0);
			first = std::min(first, static_cast<int>(std::ceil((at.x - turns) * size.x - 0.5)));
			end = std::max(end, static_cast<int>(std::floor((at.x + turns) * size.x - 0.5)) + 1);
		}
		if (end - first >= size.x) {
			r_rows.push_back({{0, row}, {size.x, row + 1}});
			continue;
		}
		// The left and right borders of the image meet.
		for (const int shift : {-size.x, 0, size.x}) {
			const PixelRect part{{std::max(first + shift, 0), row}, {std::min(end + shift, size.x), row + 1}};
			if (!part.empty()) {
				r_rows.push_back(part);
			}
		}
	}
}

} // namespace thicket
