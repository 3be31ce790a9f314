//! Instructions of the loop over steps, counted in a card's assembly.

/// Those of one turn of the loop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counted {
    /// Vector instructions.
    pub vector: u64,
    /// Of them reciprocals, roots, sines and exponentials, which a card of this kind issues at a quarter of the rate.
    pub quarter: u64,
    /// Of them in f64.
    pub double: u64,
}

/// A piece of code that is entered at its first instruction and left at a branch.
struct Block<'a> {
    name: &'a str,
    instructions: Vec<&'a str>,
}

fn blocks(assembly: &str) -> Vec<Block<'_>> {
    let mut blocks = vec![Block { name: "BB0", instructions: Vec::new() }];
    for line in assembly.lines().map(|line| line.split([';', '/']).next().unwrap_or("").trim()) {
        match line.strip_suffix(':') {
            Some(name) => blocks.push(Block { name, instructions: Vec::new() }),
            None if ["v_", "s_"].iter().any(|start| line.starts_with(start)) => {
                blocks.last_mut().expect("there is one").instructions.push(line);
            }
            None => {}
        }
    }
    blocks
}

/// Where a branch leads to.
fn target(instruction: &str) -> Option<&str> {
    let (word, rest) = instruction.split_once(' ')?;
    (word == "s_branch" || word.starts_with("s_cbranch")).then(|| rest.trim())
}

/// The longest loop: all of its instructions, and those that are left where no lane enters what it can jump over.
pub fn longest_loop(assembly: &str) -> Option<(Counted, Counted)> {
    let blocks = blocks(assembly);
    let place = |name: &str| blocks.iter().position(|block| block.name == name);
    let size = |from: usize, to: usize| -> usize {
        blocks[from..=to].iter().map(|block| block.instructions.len()).sum()
    };
    let loops = blocks.iter().enumerate().flat_map(|(end, block)| {
        let starts = block.instructions.iter().filter_map(|one| target(one)).filter_map(place);
        starts.filter(move |start| *start <= end).map(move |start| (start, end))
    });
    let (start, end) = loops.max_by_key(|(start, end)| size(*start, *end))?;
    let (mut all, mut least, mut at) = (Counted::default(), Counted::default(), start);
    for (number, block) in blocks.iter().enumerate().take(end + 1).skip(start) {
        for instruction in &block.instructions {
            all.take(instruction);
            if number < at {
                continue;
            }
            least.take(instruction);
            let skips = instruction.starts_with("s_cbranch_execz");
            if let Some(to) = target(instruction).filter(|_| skips).and_then(place)
                && (number..=end).contains(&to)
            {
                at = to;
            }
        }
    }
    Some((all, least))
}

impl Counted {
    fn take(&mut self, instruction: &str) {
        if !instruction.starts_with("v_") {
            return;
        }
        let word = instruction.split_whitespace().next().unwrap_or("");
        self.vector += 1;
        self.double += u64::from(word.contains("f64"));
        let slow = ["v_rcp_", "v_sqrt_", "v_rsq_", "v_exp_", "v_log_", "v_sin_", "v_cos_"];
        self.quarter += u64::from(slow.iter().any(|start| word.starts_with(start)));
    }

    /// Issue slots of a card whose f64 has a sixteenth of the rate.
    pub fn slots(self) -> u64 {
        let single = self.vector - self.double;
        single + 3 * self.quarter.min(single) + 16 * self.double
    }
}
