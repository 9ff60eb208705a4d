// The children of squares that are split, many squares at a time. Compiled once for each instruction set, by resolver.cpp.
#if defined(THICKET_CHILDREN_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef THICKET_CHILDREN_INL
#undef THICKET_CHILDREN_INL
#else
#define THICKET_CHILDREN_INL
#endif

#include "core/sampling/darts-inl.hpp"
#include "core/sampling/plain_steps.hpp"
#include "core/sampling/work.hpp"

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// A lane for each square.
using SplitLanes = hn::CappedTag<std::uint64_t, 8>;

/// The children, a bit each, of the squares of `places` that have a sub-square that is not known to be covered.
template <class V>
HWY_INLINE V open_children(V places, V open) {
	const SplitLanes d;
	const auto set = [d](std::uint64_t value) {
		return hn::Set(d, value);
	};
	const V level = hn::ShiftRight<2 * lattice_bits>(places);
	const V x = hn::And(hn::ShiftRight<sub_bits>(places), set(7));
	const V y = hn::And(hn::ShiftRight<sub_bits + lattice_bits - 3>(places), set(7 << 3));
	const V side = hn::Shr(set(7), level);
	const V inside = hn::Or(side, hn::ShiftLeft<3>(side));
	const V parts = hn::Shr(open, hn::AndNot(inside, hn::Or(x, y)));
	// A child's sub-squares if its corner is bit 0, and how far the next child is.
	const auto whole = hn::Eq(level, hn::Zero(d));
	const auto half = hn::Eq(level, set(1));
	const V child = hn::IfThenElse(whole, set(0x0f0f0f0f), hn::IfThenElse(half, set(0x0303), set(1)));
	const V step = hn::Shr(set(4), level);
	const V below = hn::And(parts, hn::Or(child, hn::Shl(child, step)));
	const V row = hn::Shl(step, set(3));
	const V next = hn::Shr(parts, row);
	const auto bit = [&](V bits, std::uint64_t value) {
		return hn::IfThenElseZero(hn::Ne(hn::And(bits, child), hn::Zero(d)), set(value));
	};
	const V any = hn::Or(
			hn::Or(bit(below, 1), bit(hn::Shr(below, step), 2)), hn::Or(bit(next, 4), bit(hn::Shr(next, step), 8)));
	return hn::IfThenElseZero(hn::Lt(level, set(lattice_bits)), any);
}

/// Signed numbers are what most processors compare at once.
template <class V>
HWY_INLINE void sort_pair(V &a, V &b) {
	const hn::RebindToSigned<SplitLanes> di;
	const auto later = hn::Gt(hn::BitCast(di, a), hn::BitCast(di, b));
	const auto swap = hn::BitCast(SplitLanes(), hn::IfThenElseZero(later, hn::BitCast(di, hn::Xor(a, b))));
	a = hn::Xor(a, swap);
	b = hn::Xor(b, swap);
}

/// `child_dart` of all four children of the squares.
HWY_INLINE void throw_child_darts(Splits &splits) {
	const SplitLanes d;
	const hn::RepartitionToNarrow<decltype(d)> d32;
	const hn::RebindToFloat<decltype(d32)> df;
	using V = hn::Vec<decltype(d)>;
	for (std::size_t i = 0; i < splits.count; i += hn::MaxLanes(d)) {
		const V parent = hn::Load(d, splits.parent + i);
		const V open = hn::Load(d, splits.open + i);
		const auto parent_time = hn::BitCast(d32, hn::ShiftRight<32>(parent));
		const auto place = hn::And(parent, hn::Set(d, 0xffffffffu));
		const V level = hn::Add(hn::ShiftRight<2 * lattice_bits>(place), hn::Set(d, 1));
		const V width = hn::Shr(hn::Set(d, cell_size), level);
		const V last = hn::Sub(width, hn::Set(d, 1));
		const V inside = hn::Or(last, hn::ShiftLeft<lattice_bits>(last));
		const V parent_inside = hn::Or(hn::Add(inside, inside), hn::Set(d, 1 + cell_size));
		const V corner = hn::Or(hn::AndNot(parent_inside, hn::And(place, hn::Set(d, position_mask))),
				hn::ShiftLeft<2 * lattice_bits>(level));
		// Both halves of every lane: two children at once.
		const auto times = hn::Or(parent_time, hn::BitCast(d32, hn::ShiftLeft<32>(hn::BitCast(d, parent_time))));
		const V exponent = hn::ShiftLeft<23>(hn::Add(hn::Add(level, level), hn::Set(d, 127)));
		const auto scale = hn::BitCast(df, hn::Or(exponent, hn::ShiftLeft<32>(exponent)));
		const auto tags = hn::And(times, hn::Set(d32, tag_bits));
		V random[4];
		for (std::uint32_t child = 0; child < 4; ++child) {
			V x = hn::Add(parent, hn::Set(d, (child + 1) * split_mix_gamma));
			x = hn::Mul(hn::Xor(x, hn::ShiftRight<30>(x)), hn::Set(d, split_mix_mul_0));
			x = hn::Mul(hn::Xor(x, hn::ShiftRight<27>(x)), hn::Set(d, split_mix_mul_1));
			random[child] = hn::Xor(x, hn::ShiftRight<31>(x));
		}
		V dart[4];
		for (std::uint32_t pair = 0; pair < 4; pair += 2) {
			const auto bits =
					hn::OddEven(hn::BitCast(d32, random[pair]), hn::BitCast(d32, hn::ShiftRight<32>(random[pair + 1])));
			const auto wait = hn::Mul(exponentials(d32, bits), scale);
			const auto time = hn::BitCast(d32, hn::Add(hn::BitCast(df, times), wait));
			const auto key = hn::Or(hn::And(time, hn::Set(d32, ~tag_bits)), tags);
			dart[pair] = hn::BitCast(d, hn::OddEven(key, hn::Zero(d32)));
			dart[pair + 1] = hn::ShiftLeft<32>(hn::BitCast(d, key));
		}
		for (std::uint32_t child = 0; child < 4; ++child) {
			V place_of_child = hn::Or(corner, hn::And(random[child], inside));
			if ((child & 1) != 0) {
				place_of_child = hn::Add(place_of_child, width);
			}
			if ((child & 2) != 0) {
				place_of_child = hn::Add(place_of_child, hn::ShiftLeft<lattice_bits>(width));
			}
			const V is_open = hn::And(hn::ShiftRightSame(open, static_cast<int>(child)), hn::Set(d, 1));
			const V covered = hn::ShiftRight<1>(hn::Sub(is_open, hn::Set(d, 1)));
			dart[child] = hn::Or(hn::Or(dart[child], place_of_child), covered);
		}
		sort_pair(dart[0], dart[1]);
		sort_pair(dart[2], dart[3]);
		sort_pair(dart[0], dart[2]);
		sort_pair(dart[1], dart[3]);
		sort_pair(dart[1], dart[2]);
		alignas(64) DartKey sorted[4 * hn::MaxLanes(d)];
		hn::StoreInterleaved4(dart[0], dart[1], dart[2], dart[3], d, sorted);
		const hn::CappedTag<std::uint64_t, 4> d4;
		for (std::size_t split = 0; split < hn::MaxLanes(d); ++split) {
			for (std::size_t child = 0; child < 4; child += hn::MaxLanes(d4)) {
				hn::Store(hn::Load(d4, sorted + 4 * split + child), d4,
						splits.children + (i + split) * Splits::stride + child);
			}
		}
	}
}

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
