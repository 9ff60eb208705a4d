// The vector form of smooth_patch, for as many patches as a vector has doubles. This file is
// compiled once for each instruction set.
//
// The code uses the same operations in the same order, without fusing them, so the results are
// bit-identical. Keep it in sync with smooth_patch and Heightfield.

#include "core/terrain/inner_patches.hpp"

#include <bit>

HWY_BEFORE_NAMESPACE();
namespace thicket {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// The lanes of one vector, which is no wider than a batch.
using PatchDoubles = hn::CappedTag<double, InnerPatches::capacity>;
using PatchWords = hn::RebindToUnsigned<PatchDoubles>;
using PatchFloats = hn::Rebind<float, PatchDoubles>;
using PatchD = hn::VFromD<PatchDoubles>;

/// Extracts one of the four height samples in each word as a double. The conversion is exact,
/// because a double can represent 2^52 plus the sample.
template <int column>
HWY_INLINE PatchD post(hn::VFromD<PatchWords> row) {
	constexpr int shift = 16 * (std::endian::native == std::endian::little ? column : 3 - column);
	const PatchD base = hn::Set(PatchDoubles(), 0x1p52);
	const auto bits = hn::And(hn::ShiftRight<shift>(row), hn::Set(PatchWords(), 0xffffu));
	return hn::Sub(hn::BitCast(PatchDoubles(), hn::Or(bits, hn::BitCast(PatchWords(), base))), base);
}

HWY_INLINE PatchD half_of(PatchD after, PatchD before) {
	return hn::Mul(hn::Sub(after, before), hn::Set(PatchDoubles(), 0.5));
}

/// Performs bilinear() on vectors.
HWY_INLINE PatchD interpolate(
		PatchD near_left, PatchD near_right, PatchD far_left, PatchD far_right, PatchD x, PatchD y) {
	const PatchD near = hn::Add(near_left, hn::Mul(hn::Sub(near_right, near_left), x));
	const PatchD far = hn::Add(far_left, hn::Mul(hn::Sub(far_right, far_left), x));
	return hn::Add(near, hn::Mul(hn::Sub(far, near), y));
}

HWY_INLINE void store_floats(PatchD value, float *r_to) {
	hn::Store(hn::DemoteTo(PatchFloats(), value), PatchFloats(), r_to);
}

} // namespace

/// Computes whole vectors of patches. The last vector may include entries after the last patch,
/// which contain values from earlier calls.
void compute_patches(const InnerPatches::Heights &heights, InnerPatches &r_patches) {
	const PatchDoubles doubles;
	const PatchD one = hn::Set(doubles, 1.0);
	const PatchD scale = hn::Set(doubles, heights.scale);
	for (std::size_t index = 0; index < r_patches.count; index += hn::Lanes(doubles)) {
		const auto row_of = [&](std::size_t row) {
			return hn::Load(PatchWords(), r_patches.posts[row].data() + index);
		};
		const auto before = row_of(0);
		const auto first = row_of(1);
		const auto second = row_of(2);
		const auto after = row_of(3);
		const PatchD x = hn::Load(doubles, r_patches.x.data() + index);
		const PatchD y = hn::Load(doubles, r_patches.y.data() + index);
		const PatchD a = post<1>(first);
		const PatchD b = post<2>(first);
		const PatchD c = post<1>(second);
		const PatchD d = post<2>(second);
		const PatchD rise_x = interpolate(half_of(b, post<0>(first)), half_of(post<3>(first), a),
				half_of(d, post<0>(second)), half_of(post<3>(second), c), x, y);
		const PatchD rise_y = interpolate(half_of(c, post<1>(before)), half_of(d, post<2>(before)),
				half_of(post<1>(after), a), half_of(post<2>(after), b), x, y);
		const PatchD gradient_x = hn::Mul(hn::Mul(rise_x, scale), hn::Set(doubles, heights.posts_per_meter.x));
		const PatchD gradient_y = hn::Mul(hn::Mul(rise_y, scale), hn::Set(doubles, heights.posts_per_meter.y));
		const PatchD squared = hn::Add(hn::Add(hn::Mul(gradient_x, gradient_x), hn::Mul(gradient_y, gradient_y)), one);
		const PatchD to_unit = hn::Div(one, hn::Sqrt(squared));
		const PatchD rise = hn::Mul(interpolate(a, b, c, d, x, y), scale);
		store_floats(hn::Add(hn::Set(doubles, heights.base), rise), r_patches.height.data() + index);
		store_floats(hn::Mul(hn::Neg(gradient_x), to_unit), r_patches.normal_x.data() + index);
		store_floats(to_unit, r_patches.normal_y.data() + index);
		store_floats(hn::Mul(hn::Neg(gradient_y), to_unit), r_patches.normal_z.data() + index);
	}
}

} // namespace HWY_NAMESPACE
} // namespace thicket
HWY_AFTER_NAMESPACE();
