// Computes the children of split squares, many squares at a time. resolver.cpp compiles this file
// once for each instruction set.
#if defined(THICKET_CHILDREN_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef THICKET_CHILDREN_INL
#undef THICKET_CHILDREN_INL
#else
#define THICKET_CHILDREN_INL
#endif

#include "core/sampling/child_table.hpp"
#include "core/sampling/darts-inl.hpp"
#include "core/sampling/plain_steps.hpp"
#include "core/sampling/work.hpp"

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// One lane per square.
using SplitLanes = hn::CappedTag<std::uint64_t, 8>;

/// Returns, for each square of `level_positions`, the children that have a sub-square not known to
/// be covered, one bit each.
template <class V>
HWY_INLINE V open_children(V level_positions, V open) {
	const SplitLanes d;
	const auto set = [d](std::uint64_t value) {
		return hn::Set(d, value);
	};
	const V level = hn::ShiftRight<2 * lattice_bits>(level_positions);
	const V x = hn::And(hn::ShiftRight<sub_bits>(level_positions), set(7));
	const V y = hn::And(hn::ShiftRight<sub_bits + lattice_bits - 3>(level_positions), set(7 << 3));
	const V side = hn::Shr(set(7), level);
	const V inside = hn::Or(side, hn::ShiftLeft<3>(side));
	const V parts = hn::Shr(open, hn::AndNot(inside, hn::Or(x, y)));
	// `child` contains the sub-squares of the child at the lower corner, and `step` is the offset
	// to the next child.
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

/// Lists the open children of the squares, each with its parent's dart.
HWY_INLINE void list_children(Splits &splits) {
	const hn::CappedTag<std::uint64_t, 4> d;
	const hn::CappedTag<std::uint32_t, 4> d32;
	std::uint32_t count = 0;
	for (std::uint32_t i = 0; i < splits.count; ++i) {
		const DartKey parent = splits.parent[i];
		const ChildTable::Line &line = child_table[splits.open_children[i]];
		for (std::uint32_t lane = 0; lane < 4; lane += static_cast<std::uint32_t>(hn::MaxLanes(d))) {
			const auto hash_inputs = hn::Add(hn::Load(d, line.gamma + lane), hn::Set(d, parent));
			hn::StoreU(hash_inputs, d, splits.hash_inputs + count + lane);
		}
		hn::StoreU(hn::Load(d32, line.corner), d32, splits.corner + count);
		hn::StoreU(hn::Set(d32, dart_time(parent)), d32, splits.time + count);
		hn::StoreU(hn::Set(d32, dart_level_position(parent)), d32, splits.level_position + count);
		splits.first[i] = count;
		count += line.count;
	}
	splits.first[splits.count] = count;
}

/// Performs the part of `split_mix` that follows the increment.
template <class V>
HWY_INLINE V mixed(V bits) {
	const SplitLanes d;
	bits = hn::Mul(hn::Xor(bits, hn::ShiftRight<30>(bits)), hn::Set(d, split_mix_mul_0));
	bits = hn::Mul(hn::Xor(bits, hn::ShiftRight<27>(bits)), hn::Set(d, split_mix_mul_1));
	return hn::Xor(bits, hn::ShiftRight<31>(bits));
}

/// Performs `child_dart` with vectors for the open children of the squares.
HWY_INLINE void throw_child_darts(Splits &splits) {
	const SplitLanes d64;
	const hn::RepartitionToNarrow<decltype(d64)> d;
	const hn::RebindToSigned<decltype(d)> di;
	const hn::RebindToFloat<decltype(d)> df;
	list_children(splits);
	const std::uint32_t count = splits.first[splits.count];
	for (std::uint32_t i = 0; i < count; i += static_cast<std::uint32_t>(hn::MaxLanes(d))) {
		const auto low = hn::BitCast(d, mixed(hn::Load(d64, splits.hash_inputs + i)));
		const auto high = hn::BitCast(d, mixed(hn::Load(d64, splits.hash_inputs + i + hn::MaxLanes(d64))));
		const auto parent_time = hn::Load(d, splits.time + i);
		const auto level_position = hn::Load(d, splits.level_position + i);
		const auto level = hn::Add(hn::ShiftRight<2 * lattice_bits>(level_position), hn::Set(d, 1));
		// The powers of two are built from float exponents, because many processors can shift all
		// lanes only by the same amount.
		const auto scale = hn::BitCast(df, hn::ShiftLeft<23>(hn::Add(hn::Add(level, level), hn::Set(d, 127))));
		const auto width = hn::BitCast(d,
				hn::ConvertTo(di, hn::BitCast(df, hn::ShiftLeft<23>(hn::Sub(hn::Set(d, 127 + lattice_bits), level)))));
		const auto wait = hn::Mul(exponentials(d, hn::ConcatOdd(d, high, low)), scale);
		const auto time = hn::BitCast(d, hn::Add(hn::BitCast(df, parent_time), wait));
		const auto tag = hn::And(parent_time, hn::Set(d, tag_bits));
		hn::Store(hn::Or(hn::And(time, hn::Set(d, ~tag_bits)), tag), d, splits.time + i);
		const auto both = hn::Or(width, hn::ShiftLeft<lattice_bits>(width));
		const auto inside = hn::Sub(both, hn::Set(d, 1 + cell_size));
		const auto parent_inside = hn::Or(inside, both);
		const auto origin = hn::Or(hn::AndNot(parent_inside, hn::And(level_position, hn::Set(d, position_mask))),
				hn::And(both, hn::Load(d, splits.corner + i)));
		const auto position = hn::Or(origin, hn::And(hn::ConcatEven(d, high, low), inside));
		hn::Store(hn::Or(position, hn::ShiftLeft<2 * lattice_bits>(level)), d, splits.level_position + i);
	}
}

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
