#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

namespace thicket::bench {

/// Returns the CPU time of this process in seconds. Unlike wall time, it excludes other processes
/// on the machine. These still affect caches and clock speed, so contenders take turns within
/// rounds.
inline double cpu_seconds() {
	std::timespec time{};
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
	return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// The measurements of one quantity, one per round.
class Series {
public:
	void add(double value) { values_.push_back(value); }
	std::size_t rounds() const { return values_.size(); }

	/// Returns a quantile of the rounds by the nearest rank. `fraction` is 0 to 1. There must be at
	/// least one round.
	double quantile(double fraction) const {
		std::vector<double> sorted = values_;
		std::sort(sorted.begin(), sorted.end());
		const double index = fraction * static_cast<double>(sorted.size() - 1);
		return sorted[static_cast<std::size_t>(index + 0.5)];
	}
	double median() const { return quantile(0.5); }

	/// Divides the values of each round. Both series must have been measured in the same rounds.
	friend Series operator/(const Series &a, const Series &b) {
		Series result;
		for (std::size_t i = 0; i < std::min(a.values_.size(), b.values_.size()); ++i) {
			result.add(a.values_[i] / b.values_[i]);
		}
		return result;
	}

private:
	std::vector<double> values_;
};

/// Returns items per second of CPU time. `batch`, which returns its number of items, is repeated
/// until it has taken `seconds`.
template <typename Batch>
double rate(double seconds, Batch &&batch) {
	const double start = cpu_seconds();
	double items = 0.0;
	double elapsed = 0.0;
	do {
		items += static_cast<double>(batch());
		elapsed = cpu_seconds() - start;
	} while (elapsed < seconds);
	return items / elapsed;
}

/// Prints one row of the table in docs/benchmarks.md: name, median, lowest and highest round, and number of
/// rounds.
inline void print_row(const std::string &label, const Series &series, double scale, const char *unit, int digits = 2) {
	std::printf("| %s | %.*f%s | %.*f to %.*f | %zu |\n", label.c_str(), digits, scale * series.median(), unit, digits,
			scale * series.quantile(0.0), digits, scale * series.quantile(1.0), series.rounds());
	std::fflush(stdout);
}

/// Prints a row for a figure that is counted, not timed.
inline void print_count(const std::string &label, double value, const char *unit, int digits = 2) {
	std::printf("| %s | %.*f%s | exact | 1 |\n", label.c_str(), digits, value, unit);
	std::fflush(stdout);
}

} // namespace thicket::bench
