// Force tables, which follow the rows of the drives: [table][row][column].
// Twin: crates/kernel/src/contact/force_table.rs

// Where the row that holds x begins, of the table with that number. Without a loop: lavapipe counts the rounds of all loops.
fn table_row(number: real, x: real) -> u32 {
    var row = job.drives * DRIVE_FIELDS + u32(number) * TABLE_ROWS * TABLE_COLUMNS;
    //% each half
    row += select(0u, $u * TABLE_COLUMNS, x >= drives[row + $u * TABLE_COLUMNS]);
    //% end
    return row;
}
