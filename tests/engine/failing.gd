extends "harness.gd"
## Not a test of the extension but of the harness: each of these must fail, or the others prove nothing.

func test_a_wrong_check() -> void:
	check_equal(1 + 1, 3, "sum")


func test_an_error_nobody_expects() -> void:
	check(true, "fine")
	PoissonSampler.new().radius = -1.0


func test_an_expected_error_that_does_not_come() -> void:
	check_error(["radius"], "nothing")


func test_without_a_check() -> void:
	pass
