// Force tables, which follow the rows of the drives: [table][row][column].
// Twin: crates/kernel/src/contact/force_table.rs

// Where the row that holds x begins, of the table with that number.
fn table_row(number: real, x: real) -> u32 {
    let first = job.drives * DRIVE_FIELDS + u32(number) * TABLE_ROWS * TABLE_COLUMNS;
    var row = first;
    var step = TABLE_ROWS / 2u;
    loop {
        if step == 0u {
            break;
        }
        if x >= drives[row + step * TABLE_COLUMNS] {
            row += step * TABLE_COLUMNS;
        }
        step /= 2u;
    }
    return row;
}
