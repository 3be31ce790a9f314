//! A law's functions in the shader with derivatives: its files, statement by statement, with `Dual` in place of `real`
//! (`shaders/slope/dual.wgsl`).
//!
//! `a * b + c` is one operation, as [`Lane::mul_add`](super::Lane::mul_add) is; with the product in parentheses it is two.

/// The functions and structures of `text`, with derivatives.
///
/// # Errors
/// What is not understood: the files of laws say no more than is known here.
pub(crate) fn derived(text: &str) -> Result<String, String> {
    let words = words(text);
    let mut reader = Reader { words: &words, at: 0, out: String::new(), depth: 0 };
    while reader.at < words.len() {
        reader.statement()?;
    }
    Ok(reader.out)
}

/// Signs of two characters.
const PAIRS: [&str; 3] = ["->", "&&", "||"];

/// Names, whole numbers and signs, without comments.
fn words(text: &str) -> Vec<String> {
    let mut words = Vec::new();
    for line in text.lines() {
        let mut rest = line.split("//").next().unwrap_or_default().trim_start();
        while !rest.is_empty() {
            let name = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
            let sign = if PAIRS.iter().any(|pair| rest.starts_with(pair)) { 2 } else { 1 };
            let (word, after) = rest.split_at(if name > 0 { name } else { sign.min(rest.len()) });
            words.push(word.to_owned());
            rest = after.trim_start();
        }
    }
    words
}

/// A type by its name.
fn kind(name: &str) -> String {
    match name {
        "real" => "Dual".into(),
        "bool" | "Law" => name.into(),
        _ => format!("Dual{name}"),
    }
}

/// What an expression has become.
struct Value {
    text: String,
    /// Its factors, where it is a product that stands by itself.
    factors: Option<(String, String)>,
}

impl Value {
    fn of(text: String) -> Self {
        Self { text, factors: None }
    }
}

struct Reader<'a> {
    words: &'a [String],
    at: usize,
    out: String,
    depth: usize,
}

impl Reader<'_> {
    fn peek(&self) -> &str {
        self.words.get(self.at).map_or("", String::as_str)
    }

    fn next(&mut self) -> String {
        self.at += 1;
        self.words.get(self.at - 1).cloned().unwrap_or_default()
    }

    /// Whether this word is next, which is then passed.
    fn passes(&mut self, word: &str) -> bool {
        let same = self.peek() == word;
        self.at += usize::from(same);
        same
    }

    fn must(&mut self, word: &str) -> Result<(), String> {
        if self.passes(word) { Ok(()) } else { Err(format!("`{}` where `{word}` was expected", self.peek())) }
    }

    fn line(&mut self, line: &str) {
        self.out += &"    ".repeat(self.depth);
        self.out += line;
        self.out.push('\n');
    }

    fn statement(&mut self) -> Result<(), String> {
        match self.next().as_str() {
            "struct" => self.structure(),
            "fn" => self.function(),
            "if" => {
                let condition = self.expression()?.text;
                self.must("{")?;
                self.line(&format!("if {condition} {{"));
                self.depth += 1;
                Ok(())
            }
            "}" => {
                self.depth = self.depth.checked_sub(1).ok_or("`}` without its `{`")?;
                let other = self.passes("else");
                self.line(if other { "} else {" } else { "}" });
                if other {
                    self.must("{")?;
                    self.depth += 1;
                }
                Ok(())
            }
            "return" => self.ends("return "),
            word @ ("let" | "var") => {
                let name = self.next();
                self.must("=")?;
                self.ends(&format!("{word} {name} = "))
            }
            name => {
                self.must("=")?;
                self.ends(&format!("{name} = "))
            }
        }
    }

    /// The rest of a statement, an expression.
    fn ends(&mut self, begin: &str) -> Result<(), String> {
        let value = self.expression()?.text;
        self.must(";")?;
        self.line(&format!("{begin}{value};"));
        Ok(())
    }

    fn structure(&mut self) -> Result<(), String> {
        let name = self.next();
        let members = self.named("{", "}")?;
        self.line(&format!("struct Dual{name} {{"));
        members.iter().for_each(|member| self.line(&format!("    {member},")));
        self.line("}\n");
        Ok(())
    }

    fn function(&mut self) -> Result<(), String> {
        let name = self.next();
        let given = self.named("(", ")")?.join(", ");
        self.must("->")?;
        let answer = kind(&self.next());
        self.must("{")?;
        self.line(&format!("\nfn dual_{name}({given}) -> {answer} {{"));
        self.depth += 1;
        Ok(())
    }

    /// Names with their types between two signs.
    fn named(&mut self, open: &str, close: &str) -> Result<Vec<String>, String> {
        self.must(open)?;
        let mut all = Vec::new();
        while !self.passes(close) {
            let name = self.next();
            self.must(":")?;
            all.push(format!("{name}: {}", kind(&self.next())));
            if !self.passes(",") {
                self.must(close)?;
                break;
            }
        }
        Ok(all)
    }

    fn expression(&mut self) -> Result<Value, String> {
        let mut value = self.compared()?;
        while let sign @ ("&&" | "||") = self.peek() {
            let sign = sign.to_owned();
            self.at += 1;
            let other = self.compared()?.text;
            value = Value::of(format!("{} {sign} {other}", value.text));
        }
        Ok(value)
    }

    fn compared(&mut self) -> Result<Value, String> {
        let value = self.sum()?;
        if !self.passes("<") {
            return Ok(value);
        }
        let other = self.sum()?.text;
        Ok(Value::of(format!("dual_less({}, {other})", value.text)))
    }

    fn sum(&mut self) -> Result<Value, String> {
        let mut value = self.product()?;
        loop {
            let plus = self.passes("+");
            let minus = !plus && self.passes("-");
            if !plus && !minus {
                return Ok(value);
            }
            let other = self.product()?.text;
            value = Value::of(match value.factors {
                _ if minus => format!("dual_sub({}, {other})", value.text),
                Some((a, b)) => format!("dual_mul_add({a}, {b}, {other})"),
                None => format!("dual_add({}, {other})", value.text),
            });
        }
    }

    fn product(&mut self) -> Result<Value, String> {
        let mut value = self.signed()?;
        loop {
            if self.passes("*") {
                let (a, b) = (value.text, self.signed()?.text);
                value = Value { text: format!("dual_mul({a}, {b})"), factors: Some((a, b)) };
            } else if self.passes("/") {
                let other = self.signed()?.text;
                value = Value::of(format!("dual_div({}, {other})", value.text));
            } else {
                return Ok(value);
            }
        }
    }

    fn signed(&mut self) -> Result<Value, String> {
        if self.passes("-") {
            return Ok(Value::of(format!("dual_neg({})", self.signed()?.text)));
        }
        if self.passes("!") {
            return Ok(Value::of(format!("!{}", self.signed()?.text)));
        }
        self.place()
    }

    /// A name with what follows it, or an expression in parentheses.
    fn place(&mut self) -> Result<Value, String> {
        let name = self.next();
        if name == "(" {
            let value = self.expression()?.text;
            self.must(")")?;
            // Calls need no more; truth values do.
            let called = value.ends_with(')') && !value.contains(['&', '|']);
            return Ok(Value::of(if called { value } else { format!("({value})") }));
        }
        if !name.starts_with(|c: char| c.is_alphabetic()) {
            return Err(format!("`{name}` where a value was expected"));
        }
        if self.passes("(") {
            return self.called(&name);
        }
        let mut text = name.clone();
        while self.passes(".") {
            text = format!("{text}.{}", self.next());
        }
        // Constants of the head and of the law do not depend on the approach.
        let constant = !name.contains(|c: char| c.is_lowercase()) || text.starts_with("law.");
        Ok(Value::of(if constant { format!("dual_of({text})") } else { text }))
    }

    /// A function's name, or a structure's; its arguments follow.
    fn called(&mut self, name: &str) -> Result<Value, String> {
        let mut given = Vec::new();
        while !self.passes(")") {
            given.push(self.expression()?.text);
            if !self.passes(",") {
                self.must(")")?;
                break;
            }
        }
        let structure = name.starts_with(|c: char| c.is_uppercase());
        let prefix = if structure { "Dual" } else { "dual_" };
        Ok(Value::of(format!("{prefix}{name}({})", given.join(", "))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statements_with_derivatives() {
        for (from, to) in [
            ("let x = a * b + c;", "let x = dual_mul_add(a, b, c);"),
            ("let x = (a * b) + c;", "let x = dual_add(dual_mul(a, b), c);"),
            ("let x = c + a * b;", "let x = dual_add(c, dual_mul(a, b));"),
            ("let x = a * b - c;", "let x = dual_sub(dual_mul(a, b), c);"),
            ("x = a + b + c;", "x = dual_add(dual_add(a, b), c);"),
            ("x = -a * b * c + -d;", "x = dual_mul_add(dual_mul(dual_neg(a), b), c, dual_neg(d));"),
            (
                "x = a.force / law.unit - HALF;",
                "x = dual_sub(dual_div(a.force, dual_of(law.unit)), dual_of(HALF));",
            ),
            ("return Kick(sqrt(a), ZERO);", "return DualKick(dual_sqrt(a), dual_of(ZERO));"),
            (
                "let x = !(was || may_touch(at)) && ZERO < f(law, y);",
                "let x = !(was || dual_may_touch(at)) && dual_less(dual_of(ZERO), dual_f(law, y));",
            ),
        ] {
            assert_eq!(derived(from), Ok(format!("{to}\n")));
        }
        let text = "// Words.\nstruct Path {\n    start: real,\n}\nfn f(law: Law, at: Path) -> bool {\n    if a < b {\n        x = a;\n    } else {\n        x = b;\n    }\n}\n";
        let told = derived(text).expect("it is understood");
        for part in [
            "struct DualPath {\n    start: Dual,\n}",
            "fn dual_f(law: Law, at: DualPath) -> bool {\n    if dual_less(a, b) {\n        x = a;\n    } else {\n",
        ] {
            assert!(told.contains(part), "{told}");
        }
    }

    #[test]
    fn what_is_not_understood_is_said() {
        for text in
            ["loop {", "let x = a[0];", "let x = a * ;", "}", "x += a;", "let x = 1.5;", "fn f(a) -> real {"]
        {
            assert!(derived(text).is_err(), "{text}");
        }
    }
}
