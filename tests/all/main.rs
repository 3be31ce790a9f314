//! All tests of the library and of the program that need no harness of their own, in one program: to link it once takes
//! seconds where forty programs took minutes, and its tests share the cores.
//!
//! `cargo test --test all NAME` runs those whose path contains `NAME`, for instance `exact_contact`. A name's first word says
//! where the truth comes from: a closed form (`exact_`), a published figure (`published_`), another engine or another way of
//! running (`agree_`), an order of convergence (`converge_`); `hard_` are hard cases, `cli_` the command line as a user runs
//! it, `store_` and `report_` files and pages.

// The shader's tests, a program of their own, use the rest of it.
#[allow(dead_code)]
#[path = "../checks/mod.rs"]
mod checks;
#[path = "../common/mod.rs"]
mod common;
#[path = "../continuum/mod.rs"]
mod continuum;
// As the program has them: both then give the same bits.
#[path = "../../src/elementary_functions.rs"]
mod elementary_functions;
#[path = "../pages/mod.rs"]
mod pages;
#[path = "../program/mod.rs"]
mod program;
#[path = "../study/mod.rs"]
mod study;
#[path = "../support/mod.rs"]
mod support;

mod agree_beyond;
mod agree_branches;
mod agree_compare;
mod agree_contacts;
mod agree_control;
mod agree_curves;
mod agree_kicked;
mod agree_neighbours;
mod agree_outside;
mod agree_plan;
mod agree_precision;
mod agree_reference;
mod agree_reference_engine;
mod agree_relaxing;
mod agree_rods;
mod agree_scaled;
mod agree_search;
mod agree_setpoint;
mod agree_setpoint_gap;
mod agree_shapes;
mod agree_threads;
mod agree_viscous;
mod architecture;
mod architecture_circles;
mod architecture_names;
mod cli_audit;
mod cli_bench;
mod cli_check;
mod cli_export;
mod cli_journal;
mod cli_live;
mod cli_measured;
mod cli_mistakes;
mod cli_refusals;
mod cli_run;
mod cli_schema;
mod cli_search;
mod cli_sense;
mod cli_shards;
mod cli_signals;
mod cli_spectra;
mod cli_study;
mod cli_tables;
mod cli_waveforms;
mod cli_words;
mod converge_elements;
mod converge_steps;
mod docs_levers;
mod docs_links;
mod docs_name_everything;
mod docs_name_results;
mod docs_readme;
mod docs_tuning;
mod exact_axes;
mod exact_calibration;
mod exact_contact;
mod exact_deflection;
mod exact_energy;
mod exact_fluid;
mod exact_free_motion;
mod exact_indices;
mod exact_inference;
mod exact_instrument;
mod exact_kicks;
mod exact_measured;
mod exact_periodic;
mod exact_ramp;
mod exact_reconstruction;
mod exact_reference;
mod exact_reference_engine;
mod exact_rods;
mod exact_tangents;
mod fuzz_inputs;
mod guard_left_behind;
mod hard_cases;
mod hard_contact;
mod hard_instrument;
mod hard_jumps;
mod hard_steadiness;
mod progress_phases;
mod published_paper;
mod published_tapping;
mod report_axes;
mod report_curves;
mod report_limits;
mod report_names;
mod report_pages;
mod report_uncertainty;
mod report_words;
mod scenes;
mod shader_text;
mod store_damage;
mod store_file;
mod store_followups;
mod store_place;
mod store_python;
mod store_scale;
mod sweep_library;
mod work_counters;
