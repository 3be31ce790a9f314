"""Holds the JSON schema of scenes against the scenes there are.

    python check_schema.py SCHEMA FOLDER

It accepts every good scene below FOLDER, and refuses every bad one but those listed here, which only reading can judge.
"""

import json
import sys
import tomllib
from pathlib import Path

from jsonschema import Draft7Validator

GOOD = ["scenes", "scenes/paper", "tests/scenes/good", "tests/scenes/steady", "tests/hard"]
# No TOML at all.
BROKEN = "broken_toml duplicate_key unclosed_text unquoted_quantity"
# Each key alone is right; together, or with what is left out, they are not.
RULES = """
adhesion_two_ways angle_without_shape base_amplitude_on_tip base_amplitude_with_rod branches_by_waiting calibration_half
calibration_with_tip_mass curve_also_swept curve_equal_ends curve_from_rest curve_too_large curve_two_forms
curve_waits curve_with_second_branches curve_wrong_unit design_correlated_saltelli design_correlation_of_another
design_correlations_contradict design_levels_of_sobol design_no_samples design_odd_levels design_replicates_alike
design_replicates_uneven design_too_large design_two_groups design_with_samples design_without_uncertain
drive_level_and_axis drive_two_levels force_on_actuator hamaker_default_law hamaker_needs_dmt law_axis_with_hamaker
lever_swept_other_way lever_two_ways mass_two_ways measure_too_long mode_incomplete modes_and_quality
modes_beyond_list modes_with_tip_mass output_waveforms_too_many preset_and_length preset_with_tip_shape
preset_without_quality relaxing_and_viscous relaxing_that_stiffens relaxing_under_jkr relaxing_without_time
shape_without_angle shape_under_jkr shape_under_auto cone_under_dmt shape_and_viscous radius_of_cone_swept
half_angle_too_wide layer_under_jkr layer_under_auto layer_under_sphere layer_and_viscous bonded_without_layer
cone_on_layer_under_dmt neck_under_jkr outside_under_auto neck_and_viscous table_and_viscous outside_incomplete hydration_two_ways
hydration_oscillates_by_pressure outside_beyond_list outside_of_cone forces_without_table forces_file_missing
forces_unsorted forces_end_early forces_do_not_hold forces_ragged forces_and_modulus_swept forces_unitless
forces_apart_inside forces_apart_far forces_gain_work forces_two_loops neck_breaks_first neck_breaks_first_swept neck_pushes
neck_without_length neck_linear_decays
rigid_with_voltage rigid_without_level rodless_voltage rodless_without_drive rodless_without_level run_too_long
samples_beside_same_axis samples_beside_same_curve samples_file_and_lists samples_file_with_ids samples_ragged
search_from_rest setpoint_above_one setpoint_and_force setpoint_and_gap setpoint_branch_alone setpoint_of_force deepest_without_setpoint setpoint_from_rest setpoint_waits
setpoint_with_curve setpoint_with_second_branches sweep_equal_ends sweep_missing_mode sweep_mode_beyond sweep_repeats
spectra_beyond spectra_from_rest spectra_too_many sweep_rod_of_rigid sweep_too_large table_empty table_impossible_size table_missing table_names_of_another table_nan table_negative table_ragged
table_same_id table_semicolons table_unknown_column table_unknown_name table_with_uncertain table_without_file table_without_header
table_without_rows table_without_unit tip_drive_without_level uncertain_also_swept uncertain_cut_leaves_nothing
uncertain_draws_negative uncertain_ends_exchanged uncertain_log_of_zero uncertain_mode_outside uncertain_share_of_zero
uncertain_without_design uncertain_without_spread uncertain_wrong_unit unstable_rod unstable_rod_swept voltage_on_tip
waveforms_beyond waveforms_too_long zipped_and_axis zipped_name_taken zipped_ragged
"""
# A size beyond what there is, or a unit made of several symbols: a pattern cannot reckon.
SIZES = """
angular_frequency beyond_doubles not_a_number size_quality size_radius size_stiffness size_swept_modulus sweep_bad_end
sweep_infinite_end sweep_log_through_zero
"""


def main(schema, folder):
    schema = json.loads(Path(schema).read_text())
    Draft7Validator.check_schema(schema)
    validator = Draft7Validator(schema)
    read = lambda path: tomllib.loads(path.read_text(encoding="utf-8"))
    good = [path for place in GOOD for path in sorted((folder / place).glob("*.toml"))]
    assert len(good) > 90, len(good)
    for path in good:
        errors = [f"{list(one.path)}: {one.message[:200]}" for one in validator.iter_errors(read(path))]
        assert not errors, f"{path} is refused: {errors}"
    broken, others = set(BROKEN.split()), set((RULES + SIZES).split())
    bad = sorted((folder / "tests/scenes/bad").glob("*.toml"))
    refused = 0
    for path in bad:
        try:
            scene = read(path)
        except tomllib.TOMLDecodeError:
            assert path.stem in broken, f"{path} is no TOML: list it"
            continue
        valid = validator.is_valid(scene)
        assert valid == (path.stem in others), f"{path} is {'accepted' if valid else 'refused'}: list it, or mend the schema"
        refused += not valid
    names = {path.stem for path in bad}
    assert broken | others <= names, sorted((broken | others) - names)
    print(f"schema: {len(good)} good scenes accepted, {refused} of {len(bad)} bad ones refused")


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]))
