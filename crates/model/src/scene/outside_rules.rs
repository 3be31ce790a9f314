//! What goes with forces beside a contact.

use super::SweptAxes;
use super::address::Address;
use super::draft::{Draft, Said};
use super::outside_section::{self, OUTSIDE, TABLE};
use super::params::*;
use super::paths::{HALF_ANGLE, RELAXATION, TIP_SHAPE, VISCOSITIES};
use super::sample_rules::{beside_law, exceeding, laws_of};
use super::scene_error::{Checked, Fault};
use crate::kernel::Law;
use crate::kernel::contact::TERMS;

/// Most tables of a scene.
const SHAPES: usize = 1000;

/// The forces beside the contact have a law, a tip and a sample that go with them.
pub(super) fn forces_fit(draft: &Draft, sweep: &SweptAxes) -> Checked<()> {
    shapes_fit(draft, sweep)?;
    let contact = &draft.params.contact;
    let laws = laws_of(draft, sweep);
    if laws.contains(&LawChoice::Sum) && contact.table.is_none() {
        return Err(Fault::at(draft.place_of("contact.law"), "law = \"table\" needs a table")
            .label("[contact] has none")
            .expected("table = \"force.csv\" in [contact], with columns `distance [nm]` and `force [nN]`")
            .help("add that line, or take another law"));
    }
    let Some(said) = draft.first_of(&[TABLE]).or(draft.first_of(&[OUTSIDE])) else { return Ok(()) };
    let fault = |title: &str, why: &str| Fault::at(said.key.clone(), title).label(why.to_owned());
    let known = |choice: &&LawChoice| choice.law().is_some_and(|law| law.acts() && law.summed().is_some());
    if let Some(other) = laws.iter().find(|choice| !known(choice)) {
        let why = match other.law() {
            Some(Law::None) => "law = \"none\" has no sample".to_owned(),
            Some(law) => format!("they are not known for law = \"{law}\""),
            None => {
                "law = \"auto\" goes by Tabor's parameter, which knows the contact's adhesion alone".into()
            }
        };
        return Err(beside_law(fault("the law does not know forces beside the contact", &why), draft)
            .expected("law = \"hertz\", \"dmt\", \"jkr\" or \"table\" in [contact]")
            .help("set one of them, or remove the force"));
    }
    necks_fit(draft, sweep)?;
    losses_fit(draft, &laws, said)?;
    let cap = draft.params.instrument.tip.shape == TipShape::SpheroCone;
    let back = contact.table.as_ref().is_some_and(|table| table.retraction.is_some());
    let count = contact.outside.iter().map(OutsideForce::count).sum::<usize>()
        + usize::from(contact.table.is_some())
        + usize::from(cap)
        + usize::from(back)
        + usize::from(laws.contains(&LawChoice::Dmt) && draft.first_of(&RELAXATION).is_some());
    if count > TERMS {
        return Err(fault("there are too many forces beside the contact", &format!("found {count}"))
            .expected(format!("at most {TERMS}, with a table, its way out, the cone of a charged tip, a sphero-cone's contact and DMT's attraction on a sample that relaxes among them"))
            .help("leave out the weakest"));
    }
    for (n, force) in contact.outside.iter().enumerate() {
        force_is_complete(draft, n, force)?;
    }
    let round = |shape: TipShape| shape.end() == TipEnd::Round;
    if !round(draft.params.instrument.tip.shape) && contact.outside.iter().any(OutsideForce::needs_radius) {
        return Err(fault("this force is that of a round tip", "it is in proportion to the tip's radius")
            .related(draft.place_of(TIP_SHAPE), "the shape is chosen here")
            .expected(format!("a {}", TipShape::listed(round)))
            .help("take such a shape, or give the force as a table"));
    }
    match laws.contains(&LawChoice::Sum) {
        true => table_fits(draft, sweep),
        false => Ok(()),
    }
}

/// What acts beside a contact goes with the sample's losses, and what remembers with the law.
fn losses_fit(draft: &Draft, laws: &[LawChoice], said: &Said) -> Checked<()> {
    let contact = &draft.params.contact;
    let fault = |title: &str, why: &str| Fault::at(said.key.clone(), title).label(why.to_owned());
    let remembers = contact.outside.iter().any(OutsideForce::remembers)
        || contact.table.as_ref().is_some_and(|table| table.retraction.is_some());
    let loss = draft.first_of(&VISCOSITIES).or(draft.first_of(&RELAXATION));
    if let Some(loss) = loss.filter(|_| laws.contains(&LawChoice::Sum)) {
        return Err(fault("a table needs an elastic sample", "the table is the whole force")
            .related(loss.key.clone(), "the sample's losses are given here")
            .expected("an elastic sample, or law = \"hertz\" or \"dmt\", to which the table's part outside is added")
            .help("remove the sample's losses, or take such a law"));
    }
    if let Some(loss) = loss.filter(|_| remembers) {
        return Err(fault("a force that remembers needs an elastic sample", "the sample has losses")
            .related(loss.key.clone(), "said here")
            .expected("an elastic sample, or forces without memory")
            .help("remove the sample's losses, or this force"));
    }
    if remembers && laws.contains(&LawChoice::Jkr) {
        let why = "JKR's law remembers whether there is contact, and one memory is all that there is";
        return Err(beside_law(fault("a force that remembers does not go with JKR's law", why), draft)
            .expected("law = \"hertz\" or \"dmt\", or forces without memory")
            .help("set such a law, or remove this force"));
    }
    Ok(())
}

/// A force has all that it needs, in its section or as an axis.
fn force_is_complete(draft: &Draft, n: usize, force: &OutsideForce) -> Checked<()> {
    let (known, needed) = outside_section::keys(force);
    let path = |key: &str| format!("{OUTSIDE}.{n}.{key}");
    let says = |key: &str| draft.first_of(&[&path(key)]).is_some();
    let missing = known[..needed].iter().find(|key| {
        Address::find(&path(key)).and_then(|address| address.get(&draft.params)).is_none_or(f64::is_nan)
    });
    let hydration = matches!(force, OutsideForce::Hydration { .. });
    let (title, expected) = match missing {
        Some(key) => (format!("`{OUTSIDE}.{n}` lacks `{key}`"), known[..needed].join(" and ")),
        None if hydration && says("pressure") == says("strength") => (
            format!("`{OUTSIDE}.{n}` needs one of `pressure` and `strength`"),
            "pressure, between flat walls at touch, or strength, the force at touch".to_owned(),
        ),
        None if says("cone_half_angle") != says("cone_height") => (
            format!("the cone of `{OUTSIDE}.{n}` is not complete"),
            "both cone_half_angle and cone_height, or none of them".to_owned(),
        ),
        None if says("period") && says("pressure") => (
            format!("`{OUTSIDE}.{n}` oscillates, and then needs `strength`"),
            "strength, the force at touch: a pressure between walls gives another phase".to_owned(),
        ),
        None => return Ok(()),
    };
    Err(Fault::at(draft.place_of(OUTSIDE), title)
        .label(format!("force number {n}, counted from 0"))
        .expected(expected)
        .help("complete its [[contact.outside]]"))
}

/// At most one force remembers, and it forms no farther away than it breaks.
fn necks_fit(draft: &Draft, sweep: &SweptAxes) -> Checked<()> {
    let contact = &draft.params.contact;
    let necks: Vec<usize> = (0..contact.outside.len()).filter(|n| contact.outside[*n].remembers()).collect();
    let back = contact.table.as_ref().is_some_and(|table| table.retraction.is_some());
    let fault = |path: &str, title: String| Fault::at(draft.place_of(path), title);
    if necks.len() + usize::from(back) > 1 {
        return Err(fault(OUTSIDE, "there is more than one force that remembers".into())
            .label(format!("found {}", necks.len() + usize::from(back)))
            .expected("one liquid neck, or a table with a way out of its own")
            .help("add their forces up in one table"));
    }
    let Some(n) = necks.first() else { return Ok(()) };
    let OutsideForce::Capillary { strength, forms_at, breaks_at, decay_length, model } = contact.outside[*n]
    else {
        return Ok(());
    };
    let path = |key: &str| format!("{OUTSIDE}.{n}.{key}");
    let [force, forms, breaks, decay] = ["strength", "forms_at", "breaks_at", "decay_length"].map(path);
    if let Some((forming, breaking)) = exceeding(sweep, (&forms, forms_at), (&breaks, breaks_at)) {
        return Err(fault(&forms, "the neck breaks before it forms".into())
            .label(format!("found forms_at {forming:e} m beyond breaks_at {breaking:e} m"))
            .expected("breaks_at at least as large as forms_at in every case of the scene")
            .help("on the way in a neck forms at forms_at, on the way out it breaks at breaks_at"));
    }
    if let Some((_, least)) = exceeding(sweep, ("", 0.0), (&force, strength)) {
        return Err(fault(&force, "the neck pushes".into())
            .label(format!("found {least:e} N"))
            .expected("a strength of 0 or more, the pull at touch")
            .help("leave the minus out"));
    }
    let own = draft.first_of(&[&decay]).is_some();
    let at_touch = exceeding(sweep, ("", f64::MIN_POSITIVE), (&forms, forms_at)).is_some();
    match model {
        NeckModel::Linear if own => Err(fault(&decay, format!("`{decay}` has no effect here"))
            .label("a linear neck's force ends where it breaks")
            .expected("what changes the result")
            .help("remove it, or take model = \"inverse-square\"")),
        NeckModel::InverseSquare if at_touch && decay_length.is_none() && !own => {
            Err(fault(OUTSIDE, format!("`{OUTSIDE}.{n}` needs `decay_length` or `forms_at`"))
                .label("nothing says how fast its force falls off")
                .expected("decay_length, or forms_at above 0 which stands for it")
                .help("add one of them, or take model = \"linear\""))
        }
        _ => Ok(()),
    }
}

/// Each decay length, period and phase of an oscillating force makes a table, and each half-angle of a sphero-cone.
fn shapes_fit(draft: &Draft, sweep: &SweptAxes) -> Checked<()> {
    let oscillates = |n: usize| {
        matches!(draft.params.contact.outside.get(n), Some(OutsideForce::Hydration { period: Some(_), .. }))
    };
    let keys = (0..TERMS).filter(|n| oscillates(*n));
    let waves =
        keys.flat_map(|n| ["decay_length", "period", "phase"].map(|key| format!("{OUTSIDE}.{n}.{key}")));
    let cones =
        (0..TERMS).filter(|n| draft.params.contact.outside.get(*n).is_some_and(|force| force.count() > 1));
    let cones = cones.flat_map(|n| {
        let own = ["cut_off", "cone_half_angle", "cone_height"].map(|key| format!("{OUTSIDE}.{n}.{key}"));
        own.into_iter().chain(["instrument.tip.radius".to_owned()])
    });
    let cap = draft.params.instrument.tip.shape == TipShape::SpheroCone;
    let mut count = 1usize;
    for path in waves.chain(cones).chain(cap.then(|| HALF_ANGLE.to_owned())) {
        let Some(axis) = sweep.quantities().find(|axis| axis.path == path) else { continue };
        count = count.saturating_mul(axis.values.len());
        if count > SHAPES {
            return Err(Fault::at(draft.place_of(&path), "the scene has too many tabulated forces")
                .label(format!("found {count} different ones"))
                .expected(format!("at most {SHAPES}: each half-angle of a sphero-cone makes one, each decay length, period and phase of a force that oscillates, and each shape of a charged tip's cone"))
                .help("take fewer values, or vary the strength instead"));
        }
    }
    Ok(())
}

/// A table that is the law itself holds the tip, and leaves nothing to the sample.
fn table_fits(draft: &Draft, sweep: &SweptAxes) -> Checked<()> {
    let contact = &draft.params.contact;
    let Some(table) = &contact.table else { return Ok(()) };
    let fault = |path: &str, title: String| Fault::at(draft.place_of(path), title);
    let law = LawChoice::Sum;
    let inner = table.term(true);
    let deepest = table.indentations.last().copied().unwrap_or(0.0);
    if inner.at(deepest)[1] <= 0.0 {
        return Err(fault(TABLE, "the table does not hold the tip".into())
            .label("at its deepest place the force does not rise, and deeper it goes straight on")
            .expected("a table that ends where the sample pushes back")
            .help("add rows of the contact, or take law = \"hertz\" or \"dmt\", outside of which the table then acts"));
    }
    if laws_of(draft, sweep).iter().any(|choice| *choice != law) {
        return Ok(());
    }
    let idle = |path: &str| {
        path.starts_with("sample.")
            || ["instrument.tip.youngs_modulus", "instrument.tip.poisson_ratio", TIP_SHAPE].contains(&path)
            || path == "contact.decay_length"
            || (path == "instrument.tip.radius" && !contact.outside.iter().any(OutsideForce::needs_radius))
    };
    match draft.said.iter().find(|said| {
        idle(&said.path) && (said.swept || said.path == TIP_SHAPE || said.path == "sample.thickness")
    }) {
        Some(said) => Err(Fault::at(said.key.clone(), format!("`{}` has no effect here", said.path))
            .label("the table is the whole force")
            .related(draft.place_of(TABLE), "the table is given here")
            .expected("what changes the result")
            .help("remove it, or take law = \"hertz\" or \"dmt\"")),
        None => Ok(()),
    }
}
