// A vectorized version of write_basis in placement.cpp that also writes the position. It processes
// as many instances at a time as a vector has doubles. This file is included once for each
// instruction set.
//
// The code uses the same operations as placement.cpp in the same order, without fused
// multiply-adds, so that the results are bit-identical. Keep both in sync.

#include "core/base/philox.hpp"
#include "core/placement/transform_batch.hpp"
#include "core/rules/instance_random.hpp"

#include <numbers>

HWY_BEFORE_NAMESPACE();
namespace thicket {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// The lanes of one vector. Vectors are at most as wide as a batch.
using Doubles = hn::CappedTag<double, TransformBatch::capacity>;
using Words = hn::RebindToUnsigned<Doubles>; ///< 64-bit lanes; 32-bit numbers are in the lower half.
using Halves = hn::Repartition<std::uint32_t, Words>;
using Floats = hn::Rebind<float, Doubles>;
using D = hn::VFromD<Doubles>;
using W = hn::VFromD<Words>;

HWY_INLINE D set(double value) { return hn::Set(Doubles(), value); }

struct Vector {
	D x;
	D y;
	D z;
};

struct Rotations {
	D cosine;
	D sine;
};

HWY_INLINE W low_half(W words) { return hn::And(words, hn::Set(Words(), 0xffffffffu)); }

/// Multiplies the lower halves of the words.
HWY_INLINE W product(W a, std::uint32_t b) { return hn::MulEven(hn::BitCast(Halves(), a), hn::Set(Halves(), b)); }

/// Converts words below 2^32 to doubles. The conversion is exact, because a double can represent
/// 2^52 plus the word.
HWY_INLINE D number(W words) {
	const D base = set(0x1p52);
	return hn::Sub(hn::BitCast(Doubles(), hn::Or(words, hn::BitCast(Words(), base))), base);
}

/// The random numbers of an instance: the words of instance_random, converted like unit_interval.
struct Random {
	D yaw;
	D scale;
	D tilt;
	D direction;
};

HWY_INLINE Random random_of(W ids, std::uint64_t seed) {
	const std::uint64_t key = placement_key(seed);
	auto key_0 = static_cast<std::uint32_t>(key);
	auto key_1 = static_cast<std::uint32_t>(key >> 32);
	W counter_0 = low_half(ids);
	W counter_1 = hn::ShiftRight<32>(ids);
	W counter_2 = hn::Set(Words(), static_cast<std::uint64_t>(Draw::placement));
	W counter_3 = hn::Zero(Words());
	for (int round = 0; round < philox_rounds; ++round) {
		const W product_0 = product(counter_0, philox_mul_0);
		const W product_1 = product(counter_2, philox_mul_1);
		counter_0 = hn::Xor(hn::Xor(hn::ShiftRight<32>(product_1), counter_1), hn::Set(Words(), key_0));
		counter_1 = low_half(product_1);
		counter_2 = hn::Xor(hn::Xor(hn::ShiftRight<32>(product_0), counter_3), hn::Set(Words(), key_1));
		counter_3 = low_half(product_0);
		key_0 += philox_weyl_0;
		key_1 += philox_weyl_1;
	}
	const D unit = set(0x1p-32);
	return {hn::Mul(number(counter_0), unit), hn::Mul(number(counter_1), unit), hn::Mul(number(counter_2), unit),
			hn::Mul(number(counter_3), unit)};
}

HWY_INLINE D mix(double min, double max, D t) { return hn::Add(set(min), hn::Mul(set(max - min), t)); }

/// Performs one step of Horner's method for a series with alternating signs: returns
/// coefficient - square * sum.
HWY_INLINE D step(double coefficient, D square, D sum) { return hn::Sub(set(coefficient), hn::Mul(square, sum)); }

HWY_INLINE D sine_small(D x, D square) {
	D sum = set(1.0 / 39916800.0);
	sum = step(1.0 / 362880.0, square, sum);
	sum = step(1.0 / 5040.0, square, sum);
	sum = step(1.0 / 120.0, square, sum);
	sum = step(1.0 / 6.0, square, sum);
	return hn::Sub(x, hn::Mul(hn::Mul(x, square), sum));
}

HWY_INLINE D cosine_small(D square) {
	D sum = set(1.0 / 479001600.0);
	sum = step(1.0 / 3628800.0, square, sum);
	sum = step(1.0 / 40320.0, square, sum);
	sum = step(1.0 / 720.0, square, sum);
	sum = step(1.0 / 24.0, square, sum);
	sum = step(1.0 / 2.0, square, sum);
	return hn::Sub(set(1.0), hn::Mul(square, sum));
}

/// The vector version of rotation_by().
HWY_INLINE Rotations rotation_by(D turns) {
	const D quarters = hn::Mul(turns, set(4.0));
	// Rounds to the nearest integer, and adds 8 to make the number positive. Adding 8 does not
	// change the quarter, because 8 is a multiple of 4.
	const D nearest = hn::Floor(hn::Add(quarters, set(8.5)));
	const D rest = hn::Mul(hn::Sub(quarters, hn::Sub(nearest, set(8.0))), set(std::numbers::pi / 2.0));
	const D square = hn::Mul(rest, rest);
	const D cosine = cosine_small(square);
	const D sine = sine_small(rest, square);
	const W bits = hn::BitCast(Words(), hn::Add(nearest, set(0x1p52)));
	const auto is_odd = hn::RebindMask(Doubles(), hn::TestBit(bits, hn::Set(Words(), 1)));
	const auto is_behind = hn::RebindMask(Doubles(), hn::TestBit(bits, hn::Set(Words(), 2)));
	const D unit = hn::IfThenElse(is_behind, set(-1.0), set(1.0));
	const D quarter_cosine = hn::IfThenElse(is_odd, set(0.0), unit);
	const D quarter_sine = hn::IfThenElse(is_odd, unit, set(0.0));
	return {hn::Sub(hn::Mul(cosine, quarter_cosine), hn::Mul(sine, quarter_sine)),
			hn::Add(hn::Mul(sine, quarter_cosine), hn::Mul(cosine, quarter_sine))};
}

HWY_INLINE Vector tilted_up(const Vector &up, D x, D z) {
	const D toward = hn::Add(hn::Mul(up.x, x), hn::Mul(up.z, z));
	const D fraction = hn::Div(toward, hn::Add(set(1.0), up.y));
	return {hn::Sub(x, hn::Mul(up.x, fraction)), hn::Neg(toward), hn::Sub(z, hn::Mul(up.z, fraction))};
}

HWY_INLINE Vector tilted(const Vector &up, D x, D z) {
	const auto hangs = hn::Lt(up.y, set(overhang));
	if (hn::AllFalse(Doubles(), hangs)) {
		// This is always the case for ground that is seen from above.
		return tilted_up(up, x, z);
	}
	const Vector mirrored{up.x, hn::IfThenElse(hangs, hn::Neg(up.y), up.y), hn::IfThenElse(hangs, hn::Neg(up.z), up.z)};
	const Vector half = tilted_up(mirrored, x, z);
	return {half.x, hn::IfThenElse(hangs, hn::Neg(half.y), half.y), hn::IfThenElse(hangs, hn::Neg(half.z), half.z)};
}

HWY_INLINE Vector tilted(const Vector &up, const Vector &v) {
	const Vector flat = tilted(up, v.x, v.z);
	return {hn::Add(flat.x, hn::Mul(v.y, up.x)), hn::Add(flat.y, hn::Mul(v.y, up.y)),
			hn::Add(flat.z, hn::Mul(v.y, up.z))};
}

HWY_INLINE Vector up_axis(const Vector &normal, double align) {
	const Vector up{hn::Mul(set(align), normal.x), hn::Add(set(1.0), hn::Mul(hn::Sub(normal.y, set(1.0)), set(align))),
			hn::Mul(set(align), normal.z)};
	const D squared = hn::Add(hn::Add(hn::Mul(up.x, up.x), hn::Mul(up.y, up.y)), hn::Mul(up.z, up.z));
	const D to_unit = hn::Div(set(1.0), hn::Sqrt(squared));
	const Vector axis{hn::Mul(up.x, to_unit), hn::Mul(up.y, to_unit), hn::Mul(up.z, to_unit)};
	const auto has_none = hn::Lt(squared, set(no_direction));
	if (hn::AllFalse(Doubles(), has_none)) {
		return axis;
	}
	return {hn::IfThenZeroElse(has_none, axis.x), hn::IfThenElse(has_none, set(-1.0), axis.y),
			hn::IfThenZeroElse(has_none, axis.z)};
}

/// Returns the up directions on a planet, like UpField::at(). `from_center` is
/// UpField::from_center, and `position` is relative to the same origin.
HWY_INLINE Vector up_away(const glm::dvec3 &from_center, const Vector &position) {
	const Vector from{hn::Add(set(from_center.x), position.x), hn::Add(set(from_center.y), position.y),
			hn::Add(set(from_center.z), position.z)};
	const D squared = hn::Add(hn::Add(hn::Mul(from.x, from.x), hn::Mul(from.y, from.y)), hn::Mul(from.z, from.z));
	const auto is_away = hn::Gt(squared, set(0.0));
	const D to_unit = hn::Div(set(1.0), hn::Sqrt(squared));
	return {hn::IfThenElseZero(is_away, hn::Mul(from.x, to_unit)),
			hn::IfThenElse(is_away, hn::Mul(from.y, to_unit), set(1.0)),
			hn::IfThenElseZero(is_away, hn::Mul(from.z, to_unit))};
}

/// Returns the up axes on a planet, like up_axis() in placement.cpp.
HWY_INLINE Vector up_axis(const Vector &normal, double align, const Vector &upright) {
	const auto mean = [align](D upward, D along) {
		return hn::Add(upward, hn::Mul(hn::Sub(along, upward), set(align)));
	};
	const Vector up{mean(upright.x, normal.x), mean(upright.y, normal.y), mean(upright.z, normal.z)};
	const D squared = hn::Add(hn::Add(hn::Mul(up.x, up.x), hn::Mul(up.y, up.y)), hn::Mul(up.z, up.z));
	const D to_unit = hn::Div(set(1.0), hn::Sqrt(squared));
	const auto has_none = hn::Lt(squared, set(no_direction));
	return {hn::IfThenElse(has_none, normal.x, hn::Mul(up.x, to_unit)),
			hn::IfThenElse(has_none, normal.y, hn::Mul(up.y, to_unit)),
			hn::IfThenElse(has_none, normal.z, hn::Mul(up.z, to_unit))};
}

HWY_INLINE D load(const float *from) { return hn::PromoteTo(Doubles(), hn::Load(Floats(), from)); }
HWY_INLINE hn::VFromD<Floats> rounded(D value) { return hn::DemoteTo(Floats(), value); }

/// Returns the up axes of the instances from `at` on.
HWY_INLINE Vector up_of(
		const Placement &placement, const UpField &up_field, const TransformBatch &batch, std::size_t at) {
	const Vector normal{
			load(batch.normal_x.data() + at), load(batch.normal_y.data() + at), load(batch.normal_z.data() + at)};
	if (!up_field.away) {
		return up_axis(normal, placement.align_to_normal);
	}
	const Vector position{
			load(batch.position_x.data() + at), load(batch.position_y.data() + at), load(batch.position_z.data() + at)};
	return up_axis(normal, placement.align_to_normal, up_away(up_field.from_center, position));
}

} // namespace

/// Computes the transforms of whole vectors of instances. The last vector may include entries after
/// the last instance, with numbers from earlier calls. `fractions` has TransformBatch::capacity
/// fractions of the range of scales, aligned to 64 bytes, or is null if the fractions are random.
void make_transforms(const Placement &placement, std::uint64_t seed, const UpField &up_field, const double *fractions,
		TransformBatch &r_batch) {
	const Doubles doubles;
	const bool leans = placement.max_tilt_degrees > 0.0;
	for (std::size_t at = 0; at < r_batch.count; at += hn::Lanes(doubles)) {
		const Random random = random_of(hn::Load(Words(), r_batch.ids.data() + at), seed);
		const D yaw = mix(placement.min_yaw_degrees, placement.max_yaw_degrees, random.yaw);
		const D fraction = fractions != nullptr ? hn::Load(doubles, fractions + at) : random.scale;
		const D scale = mix(placement.min_scale, placement.max_scale, fraction);
		Rotations yaws = rotation_by(hn::Div(yaw, set(360.0)));
		if (r_batch.has_headings) {
			const D cosine = hn::Load(doubles, r_batch.heading_cosine.data() + at);
			const D sine = hn::Load(doubles, r_batch.heading_sine.data() + at);
			yaws = {hn::Sub(hn::Mul(yaws.cosine, cosine), hn::Mul(yaws.sine, sine)),
					hn::Add(hn::Mul(yaws.sine, cosine), hn::Mul(yaws.cosine, sine))};
		}
		const Vector up = up_of(placement, up_field, r_batch, at);
		Vector axis = up;
		if (leans) {
			const D tilt = mix(placement.min_tilt_degrees, placement.max_tilt_degrees, random.tilt);
			const Rotations lean = rotation_by(hn::Div(tilt, set(360.0)));
			const Rotations towards = rotation_by(random.direction);
			axis = {hn::Mul(lean.sine, towards.cosine), lean.cosine, hn::Mul(lean.sine, towards.sine)};
		}
		Vector x = tilted(axis, yaws.cosine, hn::Neg(yaws.sine));
		Vector y = axis;
		Vector z = tilted(axis, yaws.sine, yaws.cosine);
		if (leans) {
			x = tilted(up, x);
			y = tilted(up, y);
			z = tilted(up, z);
		}
		const auto write = [&](std::size_t row, D of_x, D of_y, D of_z, const float *position) {
			hn::StoreInterleaved4(rounded(hn::Mul(scale, of_x)), rounded(hn::Mul(scale, of_y)),
					rounded(hn::Mul(scale, of_z)), hn::Load(Floats(), position + at), Floats(),
					r_batch.rows[row].data() + TransformBatch::row_floats * at);
		};
		write(0, x.x, y.x, z.x, r_batch.position_x.data());
		write(1, x.y, y.y, z.y, r_batch.position_y.data());
		write(2, x.z, y.z, z.z, r_batch.position_z.data());
		hn::Store(rounded(scale), Floats(), r_batch.scale.data() + at);
	}
}

} // namespace HWY_NAMESPACE
} // namespace thicket
HWY_AFTER_NAMESPACE();
